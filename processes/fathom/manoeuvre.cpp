// fathom compare --manoeuvre: two sets of hydrodynamic derivatives flown through the same manoeuvre, side by side.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <numbers>
#include <optional>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/model/manoeuvres.hpp"
#include "common/report/plot.hpp"
#include "common/tables/writer.hpp"
#include "processes/fathom/commands.hpp"

namespace fathom::tool {
namespace {

using Flight = std::vector<model::FlightMoment>;

constexpr double kEvery = 0.1;                        // s
constexpr double kDegree = std::numbers::pi / 180.0;  // rad

/// A vehicle file, or a file of coefficients alone for the vehicle `base`: in place of all of its own, or `over` them.
model::Vehicle vehicle_of(const std::string& path, const model::Vehicle* base, bool over) {
  const Config config = Config::load(path);
  if (base == nullptr && !config.has("name"))
    throw InputError(path + ": coefficients alone; name the vehicle that they are for (--vehicle)");
  if (base == nullptr || config.has("name")) return model::Vehicle::load(path);
  model::Vehicle vehicle = *base;
  if (!vehicle.hydrodynamics) throw InputError(base->name + ": the vehicle file has no section hydrodynamics");
  std::vector<model::ManoeuvringCoefficient> own = std::move(vehicle.hydrodynamics->coefficients);
  auto& set = vehicle.hydrodynamics->coefficients;
  set = model::read_coefficients(config.section("coefficients"), *vehicle.hydrodynamics->set);
  if (config.has("source")) static_cast<void>(config.text("source"));
  config.finish();
  std::erase_if(own, [&](const auto& one) {
    return std::ranges::find(set, one.term, &model::ManoeuvringCoefficient::term) != set.end();
  });
  if (over) set.insert(set.end(), own.begin(), own.end());
  return vehicle;
}

struct Figures {
  double speed{}, drift{}, yaw_rate{}, radius{}, pitch{}, overshoot{}, period{};
};

double yaw(const model::FlightMoment& m) { return euler_from_rotation(m.q_WB.toRotationMatrix()).z(); }

/// Means over the second half; overshoot and period of a zigzag from its turns of heading.
Figures figures_of(const Flight& flight, const model::Manoeuvre& manoeuvre) {
  Figures f;
  double n = 0.0, last_turn = 0.0, turns = 0.0, first_turn = 0.0;
  for (std::size_t k = flight.size() / 2; k < flight.size(); ++k) {
    const model::FlightMoment& m = flight[k];
    const double u = std::hypot(m.nu[0], m.nu[1]);
    f.speed += u;
    f.drift += std::atan2(m.nu[1], m.nu[0]);
    f.yaw_rate += m.nu[5];
    f.pitch += euler_from_rotation(m.q_WB.toRotationMatrix()).y();
    f.overshoot = std::max(f.overshoot, std::abs(wrap_angle(yaw(m) - manoeuvre.heading)) - manoeuvre.swing);
    if (k > 0 && m.nu[5] > 0.0 && flight[k - 1].nu[5] <= 0.0) {
      if (turns == 0.0) first_turn = m.t;
      last_turn = m.t;
      turns += 1.0;
    }
    n += 1.0;
  }
  f.speed /= n;
  f.drift /= n;
  f.yaw_rate /= n;
  f.pitch /= n;
  f.radius = f.yaw_rate != 0.0 ? f.speed / std::abs(f.yaw_rate) : 0.0;
  f.period = turns > 1.0 ? (last_turn - first_turn) / (turns - 1.0) : 0.0;
  return f;
}

void line(const char* name, double a, double b, const char* unit) {
  std::printf("%-28s %12.4g %12.4g  %s\n", name, a, b, unit);
}

std::string label(const std::string& path) { return std::filesystem::path{path}.filename().string(); }

std::string block(const char* name, const Flight& flight) {
  std::string text = std::string{name} + " << EOD\n";
  for (const model::FlightMoment& m : flight) {
    text += std::to_string(m.p_WB.x()) + " " + std::to_string(m.p_WB.y()) + "\n";
  }
  return text + "EOD\n";
}

/// As seen from above, north to the right; to scale unless that flattens both tracks to a line.
std::string axes(const Flight& one, const Flight& two, const report::Figure& figure) {
  Eigen::Vector2d low = one.front().p_WB.head<2>(), high = low;
  for (const Flight* flight : {&one, &two}) {
    for (const model::FlightMoment& m : *flight) {
      low = low.cwiseMin(m.p_WB.head<2>());
      high = high.cwiseMax(m.p_WB.head<2>());
    }
  }
  constexpr double kEdge = 1.1, kFlat = 0.25, kLeast = 0.5;  // shares, and m
  const Eigen::Vector2d pixels(figure.width - figure.left - figure.right, figure.height - figure.top - figure.bottom);
  const Eigen::Vector2d span = (high - low).cwiseMax(kLeast), middle = 0.5 * (low + high);
  Eigen::Vector2d shown = kEdge * span.cwiseQuotient(pixels).maxCoeff() * pixels;
  const bool flat = span.y() < kFlat * shown.y();
  if (flat) shown.y() = kEdge * span.y();
  char text[320];
  std::snprintf(text, sizeof text,
                "set xrange [%.3f:%.3f]\nset yrange [%.3f:%.3f]\nset xlabel 'north [m]' offset 0, 0.6\n"
                "set ylabel 'east [m]%s'\n",
                middle.x() - 0.5 * shown.x(), middle.x() + 0.5 * shown.x(), middle.y() + 0.5 * shown.y(),
                middle.y() - 0.5 * shown.y(), flat ? ", stretched" : "");
  return text;
}

}  // namespace

void compare_manoeuvre(const ManoeuvreComparison& asked) {
  const auto& [first, second, name, plot, vehicle, over, rudder] = asked;
  std::optional<model::Vehicle> base;
  if (!vehicle.empty()) base = model::Vehicle::load(vehicle);
  const model::Vehicle a = vehicle_of(first, base ? &*base : nullptr, over);
  const model::Vehicle b = vehicle_of(second, base ? &*base : &a, over);
  model::Manoeuvre manoeuvre = model::manoeuvre_for(a, name);
  if (model::steered_by_rudder(a) != model::steered_by_rudder(b))
    throw InputError("one of the two steers by a rudder, the other by thrusters: their manoeuvres are not alike");
  const bool steered = model::steered_by_rudder(a);
  if (steered) manoeuvre.rudder = manoeuvre.swing = rudder * kDegree;
  std::optional<model::Divergence> lost_a, lost_b;
  Flight one = model::fly(a, manoeuvre, kEvery, nullptr, &lost_a);
  Flight two = model::fly(b, manoeuvre, kEvery, nullptr, &lost_b);
  const auto tell = [](const std::string& path, const std::optional<model::Divergence>& lost) {
    if (lost) std::printf("%s %s; compared until then\n", label(path).c_str(), lost->text().c_str());
  };
  tell(first, lost_a);
  tell(second, lost_b);
  const std::size_t both = std::min(one.size(), two.size());
  if (both < 2) throw InputError("the motion of one set is lost at once; there is nothing to compare");
  one.resize(both);
  two.resize(both);
  const Figures x = figures_of(one, manoeuvre), y = figures_of(two, manoeuvre);
  char rule[96] = "the same thrusters' rule for both";
  if (steered)
    std::snprintf(rule, sizeof rule, "rudder at %g deg, each from its cruising speed, which its propellers keep",
                  rudder);
  std::printf("%s, %.0f s, %s; means over the second half\n%-28s %12s %12s\n", name.c_str(), one.back().t, rule, "",
              "first", "second");
  line("speed", x.speed, y.speed, "m/s");
  line("drift angle", x.drift, y.drift, "rad");
  line("pitch", x.pitch, y.pitch, "rad");
  if (manoeuvre.kind == model::ManoeuvreKind::kCircle) {
    line("yaw rate", x.yaw_rate, y.yaw_rate, "rad/s");
    line("radius", x.radius, y.radius, "m");
    const model::TurnFigures p = model::turn_figures(one, manoeuvre), q = model::turn_figures(two, manoeuvre);
    if (p.advance && q.advance) line("advance", *p.advance, *q.advance, "m");
    if (p.transfer && q.transfer) line("transfer", *p.transfer, *q.transfer, "m");
    if (p.tactical_diameter && q.tactical_diameter)
      line("tactical diameter", *p.tactical_diameter, *q.tactical_diameter, "m");
  }
  if (manoeuvre.kind == model::ManoeuvreKind::kZigzag) {
    line("overshoot of heading", x.overshoot, y.overshoot, "rad");
    line("period", x.period, y.period, "s");
  }
  Vector6d square = Vector6d::Zero();
  double apart = 0.0, turned = 0.0;
  for (std::size_t k = 0; k < one.size(); ++k) {
    square += (one[k].nu - two[k].nu).cwiseAbs2();
    apart = std::max(apart, (one[k].p_WB - two[k].p_WB).norm());
    turned = std::max(turned, std::abs(wrap_angle(yaw(one[k]) - yaw(two[k]))));
  }
  const Vector6d rms = (square / static_cast<double>(one.size())).cwiseSqrt();
  std::printf("difference, rms: u %.4f v %.4f w %.4f m/s, p %.4f q %.4f r %.4f rad/s\n", rms[0], rms[1], rms[2], rms[3],
              rms[4], rms[5]);
  std::printf("difference, largest: %.2f m of position, %.2f rad of heading; at the end %.2f m\n", apart, turned,
              (one.back().p_WB - two.back().p_WB).norm());
  if (plot.empty()) return;
  report::Figure figure{.alt = "Tracks of two sets of derivatives", .width = 560, .height = 420, .top = 50};
  figure.left = 70;
  figure.script = block("$a", one) + block("$b", two) + axes(one, two, figure) +
                  "set key at screen 0.97, 0.97\nplot $a with lines lw 2 lc rgb '#22262b' title " +
                  report::quoted(label(first)) + ", $b with lines lw 2 dt 2 lc rgb '#e07b00' title " +
                  report::quoted(label(second)) + "\n";
  tables::write_file(plot, report::svg_file(figure));
}

}  // namespace fathom::tool
