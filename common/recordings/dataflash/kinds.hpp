// The kinds of records of one DataFlash file: what FMT, FMTU, UNIT and MULT say about their fields, and their topics.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/recordings/topic.hpp"

namespace fathom::recordings::dataflash {

/// Bytes of a field of this letter; 0 for a letter that is not known.
[[nodiscard]] std::size_t size_of(char letter);
[[nodiscard]] bool is_words(char letter);

/// One kind of record, as its FMT says.
struct Kind {
  std::string name;
  std::string letters;  ///< one per column
  std::vector<std::string> columns;
  std::size_t length{};            ///< of the whole record
  bool readable{};                 ///< letters are known and fit into the length
  std::string units, multipliers;  ///< ids, one letter a column, from FMTU; empty: never said
  int time{-1};                    ///< column of TimeUS or TimeMS
  double time_factor{1.0};         ///< to us
  int instance{-1};                ///< column that tells instances apart
  int period{-1}, shift{-1};  ///< VISO: columns of the time and of the first of three shifts, which make a velocity
  bool settled{};             ///< instance and topics are decided: the first record has come
  struct Own {
    std::size_t topic{};
    bool wanted{};  ///< somebody wants its numbers
  };
  std::map<int, Own> topics;  ///< by instance; -1 where there is none
};

class Kinds {
 public:
  explicit Kinds(Sink& sink) : sink_(sink) {}
  /// From a FMT record; false when it is no description.
  bool describe(int type, std::size_t length, std::string_view name, std::string_view letters,
                std::string_view columns);
  void units(int type, std::string_view units, std::string_view multipliers);
  void unit(char id, std::string_view label) { labels_[static_cast<unsigned char>(id)] = label; }
  void multiplier(char id, double factor) { factors_[static_cast<unsigned char>(id)] = factor; }
  [[nodiscard]] Kind* find(int type) { return kinds_[static_cast<std::size_t>(type & 0xFF)].get(); }
  /// The kind of this name, for the text form.
  [[nodiscard]] Kind* find(std::string_view name);
  /// The topic of an instance, made when it is first asked for.
  Kind::Own topic(Kind& kind, int instance);
  /// Decides which column is the instance, once FMTU has had its say.
  void settle(Kind& kind);

 private:
  [[nodiscard]] std::string unit_of(const Kind& kind, std::size_t column) const;

  Sink& sink_;
  std::array<std::unique_ptr<Kind>, 256> kinds_;
  std::vector<std::unique_ptr<Kind>> former_;  ///< replaced by another of the same type
  std::array<std::string, 256> labels_;
  std::array<std::optional<double>, 256> factors_;
  std::map<std::string, Kind::Own> named_;  ///< by name, letters and columns
  std::set<std::string> names_;             ///< of topics
  std::map<std::string, int, std::less<>> by_name_;
};

}  // namespace fathom::recordings::dataflash
