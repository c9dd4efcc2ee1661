// What the sealed benchmark's owners of torpedoes, boats, ships and gliders write is read: vehicle file, column map and
// commands, which give the forces that were told.
#include <doctest/doctest.h>

#include "common/model/actuators.hpp"
#include "common/tables/column_map.hpp"
#include "common/tables/csv.hpp"
#include "common/tables/import.hpp"
#include "test/sealed/dives/other_writing.hpp"
#include "test/sealed/dives/writing.hpp"
#include "test/support/scratch.hpp"

namespace fathom {
namespace {

constexpr double kRead = 5e-4;  // of a force: a file has six digits, and gravity is 9.81 m/s^2 there and 9.80665 here

}  // namespace

TEST_CASE("tables: what owners of torpedoes, boats, ships and gliders write is read, with the forces that were told") {
  using namespace sealed;
  for (const CraftClass craft_class :
       {CraftClass::kTorpedo, CraftClass::kBoat, CraftClass::kShip, CraftClass::kGlider}) {
    Random random(4, "test");
    SealedSet set;
    set.plan.craft_class = craft_class;
    set.craft = draw_other_craft(craft_class, random);
    CAPTURE(set.craft.family);
    set.site.half << 60.0, 60.0, 3.0;
    set.site.centre << 0.0, 0.0, set.craft.surfaced ? 0.0 : 9.0;
    set.train.push_back(dive(set.craft, set.site, {}, {}, {.length = 6.0, .seed = 2, .purpose = "test"}));
    const test::Scratch scratch;
    const model::Vehicle vehicle = [&] {
      test::write_bytes(scratch.path("vehicle.yaml"), to_vehicle_file(set));
      return model::Vehicle::load(scratch.path("vehicle.yaml"));
    }();
    CHECK(vehicle.thrusters.size() == set.craft.jets.size());
    CHECK(vehicle.dof == set.craft.moves);
    if (!logs_commands(set.craft)) continue;
    const tables::CsvTable table = tables::parse_csv(to_csv(set, set.train.front()), "run.csv");
    const tables::ColumnMap map = tables::ColumnMap::parse(to_map(set.craft, false), "map.yaml");
    const tables::Imported imported = tables::import_table(table, map, vehicle.dof);
    const Dive& run = set.train.front();
    REQUIRE(imported.recording.thrusters.size() == run.size());
    for (std::size_t k = 0; k < run.size(); k += 50) {
      const Eigen::VectorXd& told = run.command(k);
      const std::vector<double> force = model::forces_of_commands(vehicle, imported.recording.thrusters[k].pwm_us, 0.0);
      REQUIRE(force.size() == set.craft.jets.size());
      for (std::size_t i = 0; i < force.size(); ++i) {
        const double largest = set.craft.jets[i].largest;
        CHECK(std::abs(force[i] - told[static_cast<Eigen::Index>(i)]) < kRead * largest);
      }
    }
  }
}

}  // namespace fathom
