// The place of a dive as config/sites/*.yaml describes it: water, boundaries, tags, transponders. Axes of W: north,
// east, down from the site's origin, which the file chooses; the surface need not be at z = 0.
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "common/model/lens.hpp"

namespace fathom {
class Config;
}

namespace fathom::model {

/// What is printed on a tag: numbers are those of a family, as the AprilTag library names it.
struct TagName {
  std::string family;
  int id{};
  bool operator==(const TagName&) const = default;
  bool operator<(const TagName& other) const { return std::tie(family, id) < std::tie(other.family, other.id); }
};

/// A fiducial tag. Frame T: origin in its middle, x to the right and y down as one reads it, z into it.
struct Tag {
  int id{};
  double size{};                                  ///< m, edge of the black square
  Eigen::Vector3d p_WT{Eigen::Vector3d::Zero()};  ///< m
  Eigen::Matrix3d R_WT{Eigen::Matrix3d::Identity()};
  std::string family{};             ///< empty: the first that is looked for here
  std::optional<int> own_number{};  ///< where tags of two families have the same id

  /// Which of a site's frames T it is: no two have the same. That of TAG_POSE.
  [[nodiscard]] int number() const { return own_number.value_or(id); }
};

/// Families may be named without the library's "tag" in front.
[[nodiscard]] bool same_family(std::string_view a, std::string_view b);

/// Something that answers an acoustic ping.
struct Transponder {
  std::string name;
  Eigen::Vector3d p_W{Eigen::Vector3d::Zero()};  ///< m
};

/// How tags are looked for in pictures of this place.
struct TagSearch {
  std::vector<std::string> families{"tag36h11"};  ///< as the AprilTag library names them
  /// Decision margin below which a tag is believed only where others say it must be; left out: by the family's
  /// strength.
  std::optional<double> least_margin;
  double map_sigma{2e-3};  ///< m, error of the tags' surveyed places
};

struct Site {
  static constexpr double kNone = std::numeric_limits<double>::infinity();

  std::string name;
  double water_density{};              ///< kg/m^3
  double gravity{};                    ///< m/s^2
  double sound_speed{};                ///< m/s
  double surface{};                    ///< m, z of the water's surface
  double floor{};                      ///< m, z of the bottom
  double north{kNone}, south{-kNone};  ///< m, x of the walls; infinite where there is none
  double east{kNone}, west{-kNone};    ///< m, y of the walls
  double declination{};                ///< rad, heading of magnetic north in W
  std::vector<Tag> tags;
  std::vector<TagName> doubtful_tags;  ///< what stands twice in the map: pictures cannot tell which; not in `tags`
  TagSearch search;
  std::optional<Lens> lens;               ///< of the camera that took pictures here, where no vehicle file states it
  std::vector<Transponder> transponders;  ///< order of RANGES
  std::optional<Eigen::Vector3d> transceiver;    ///< m, of the USBL, in W
  std::optional<Eigen::Vector3d> tether_anchor;  ///< m, in W

  /// InputError with file and line when anything is missing, unknown, or in a wrong unit.
  [[nodiscard]] static Site load(const std::string& path);
  /// The same of a file that has been read already.
  [[nodiscard]] static Site from(const Config& config);
  /// The same for recorded pictures alone: water and declination may be left out,
  /// and what is printed on two tags costs these two, not the site.
  [[nodiscard]] static Site load_for_pictures(const std::string& path);
  /// The tag of that number, or nullptr.
  [[nodiscard]] const Tag* tag(int number) const;
  /// The tag on which this is printed, or nullptr.
  [[nodiscard]] const Tag* tag(std::string_view family, int id) const;
  [[nodiscard]] const std::string& family_of(const Tag& tag) const;
  /// Other families are looked for. A map that names none is then of the first of these; one that does is as it was.
  void look_for(const std::vector<std::string>& families);
  /// A line about the doubtful tags; empty when there are none.
  [[nodiscard]] std::string doubts() const;
  [[nodiscard]] double depth() const { return floor - surface; }
};

}  // namespace fathom::model
