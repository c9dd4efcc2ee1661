// A floor with two posters: ids of the second begin where those of the first do.
#pragma once

#include <fstream>

#include "common/model/site.hpp"
#include "test/support/scratch.hpp"

namespace fathom::vision::test_scene {

inline constexpr int kSecondNumber = 1000;

inline std::string two_families_text() {
  const std::string rows = "rows: 4, columns: 4, size: 0.15 m, pitch: 0.4 m, rotation: 0 0 0 deg";
  return "site: two\nwater: {density: 998 kg/m^3, gravity: 9.81 m/s^2, sound_speed: 1480 m/s, surface: 0 m, floor: 1.5 "
         "m}\n"
         "declination: 0 deg\ntag_search: {families: [tag36h11, tag16h5], map_sigma: 1 mm}\nposter:\n"
         "  - {first: 0, middle: -0.8 0 1.5 m, " +
         rows + "}\n" + "  - {first: 0, family: tag16h5, number: " + std::to_string(kSecondNumber) +
         ", middle: 0.8 0 1.5 m, " + rows + "}\n";
}

inline model::Site two_families() {
  const test::Scratch scratch;
  std::ofstream{scratch.path("two.yaml")} << two_families_text();
  return model::Site::load(scratch.path("two.yaml"));
}

}  // namespace fathom::vision::test_scene
