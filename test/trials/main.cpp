// Simulated trials: fathom_trials record DIR [SEED] | figures DIR [SEED] | consistency [N] | variations | selection [N]
// | recovery [N] | dives DIR [N]
#include <cstdio>
#include <cstdlib>
#include <exception>

#include "common/estimation/smoothing/process_tuning.hpp"
#include "common/wire/log_writer.hpp"
#include "test/trials/trials.hpp"

namespace fathom::trials {

Setup setup() {
  Setup s{model::Vehicle::load(std::string{FATHOM_SOURCE_DIR} + "/config/vehicles/pap104_half.yaml"),
          test::instruments_from_repository("pap104_half")};
  const auto trial =
      test::record_trial(s.vehicle, s.instruments, {.manoeuvre = model::manoeuvre_preset("circle"), .seed = 1000});
  s.instruments = estimation::tune_process(trial.recording, s.instruments);
  return s;
}

void record(const std::string& folder, unsigned seed) {
  const Setup s = setup();
  unsigned offset = 0;
  for (const char* name : {"line", "zigzag", "circle"}) {
    const auto trial = test::record_trial(s.vehicle, s.instruments,
                                          {.manoeuvre = model::manoeuvre_preset(name), .seed = seed + offset++});
    const std::string path = folder + "/" + name + ".lcmlog";
    wire::write_log(trial.recording, path);
    std::printf("%s\n", path.c_str());
  }
}

}  // namespace fathom::trials

int main(int argc, char** argv) {
  using namespace fathom::trials;
  const std::string what = argc > 1 ? argv[1] : "";
  const auto number = [&](int at, int otherwise) { return argc > at ? std::atoi(argv[at]) : otherwise; };
  try {
    if (what == "record" && argc > 2) {
      record(argv[2], static_cast<unsigned>(number(3, 1)));
    } else if (what == "figures" && argc > 2) {
      figures(argv[2], static_cast<unsigned>(number(3, 1)));
    } else if (what == "consistency") {
      consistency(number(2, 50));
    } else if (what == "variations") {
      variations();
    } else if (what == "selection") {
      selection(number(2, 50));
    } else if (what == "recovery") {
      for (const bool exact_motion : {true, false}) {
        for (const double cell_gain : {0.03, 0.0}) recovery(number(2, 50), cell_gain, exact_motion);
      }
    } else if (what == "dives" && argc > 2) {
      record_dives(argv[2], number(3, 3));
    } else {
      std::fprintf(stderr,
                   "fathom_trials record DIR [SEED] | figures DIR [SEED] | consistency [N] | variations | "
                   "selection [N] | recovery [N] | dives DIR [N]\n");
      return 2;
    }
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "fathom_trials: %s\n", error.what());
    return 1;
  }
}
