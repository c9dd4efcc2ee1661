// One axis of a sensor that is far noisier than its other two.
#include <algorithm>
#include <array>

#include "common/base/statistics.hpp"
#include "common/base/units.hpp"
#include "common/consistency/consistency.hpp"
#include "common/estimation/wording.hpp"

namespace fathom::consistency {

std::vector<ConsistencyFinding> compare_noise(std::span<const RunSignals> runs) {
  std::vector<ConsistencyFinding> findings;
  const auto check = [&](const std::string& signal, const std::vector<Series>& series, double floor, const char* unit) {
    std::array<double, 3> sigma{};
    for (int k = 0; k < 3; ++k) {
      std::vector<double> one;
      for (const Series& run : series) {
        std::vector<double> part;
        for (const Eigen::Vector3d& x : run.x) part.push_back(x[k]);
        if (part.size() > 100) one.push_back(white_noise_sigma(run.t, part));
      }
      sigma[static_cast<std::size_t>(k)] = median(std::move(one));
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const double others = std::max(sigma[(k + 1) % 3], sigma[(k + 2) % 3]);
      if (sigma[k] < 5.0 * others || sigma[k] < floor || others <= 0.0) continue;
      findings.push_back(
          {.run = "all",
           .signal = signal + "." + (signal == "gyro" ? "pqr" : "uvw")[k],
           .reference = "its other axes",
           .finding = "noise",
           .size = sigma[k],
           .unit = unit,
           .evidence = text("white noise %.3g, on the other axes at most %.3g ", sigma[k], others) + unit,
           .action = "weighted by its noise"});
    }
  };
  std::vector<Series> gyro, dvl;
  for (const RunSignals& run : runs) {
    gyro.push_back(run.gyro);
    dvl.push_back(run.dvl);
  }
  check("gyro", gyro, 0.5 * kDegree, "rad/s");
  check("dvl", dvl, 0.01, "m/s");
  return findings;
}

}  // namespace fathom::consistency
