// Parts of a split recording as one: topics of the same name and type are the same, whatever their numbers in each
// part.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/recordings/topic.hpp"

namespace fathom::recordings {

class JoinedParts final : public Sink {
 public:
  explicit JoinedParts(Sink& whole) : whole_(whole) {}
  /// What comes from now on is of another part, with numbers of its own.
  void next_part() { topics_.clear(); }

  bool topic(std::size_t number, const Topic& topic) override;
  void further_field(std::size_t topic, const Field& field) override;
  void message(std::size_t topic, Stamp stamp, std::span<const double> values) override;
  void text(std::size_t topic, std::string_view field, std::string_view words) override;

 private:
  struct Whole {
    std::size_t number{};
    bool wanted{};
    std::map<std::string, std::size_t> fields;
  };
  struct Part {
    Whole* whole{};
    std::vector<std::size_t> fields;  ///< of the part to those of the whole
  };
  std::size_t place(Whole& whole, const Field& field);

  Sink& whole_;
  std::map<std::string, Whole> known_;  ///< by name and type
  std::vector<Part> topics_;
  std::vector<double> values_;
};

}  // namespace fathom::recordings
