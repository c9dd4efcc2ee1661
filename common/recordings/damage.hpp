// What a reader could not read, counted by kind, with the place of the first: one sentence each.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace fathom::recordings {

class Damage {
 public:
  /// `bytes` at `offset` are lost for the reason `what`, which is a plural: "records with a wrong checksum".
  void add(const std::string& what, std::uint64_t offset, std::uint64_t bytes);
  /// The same for what has no place in a file of bytes.
  void add(const std::string& what);
  [[nodiscard]] bool none() const { return kinds_.empty(); }
  [[nodiscard]] std::uint64_t bytes() const;
  [[nodiscard]] std::uint64_t places(const std::string& what) const;
  /// "12 bytes that belong to no record, in 2 places, the first at byte 4711"
  [[nodiscard]] std::vector<std::string> sentences() const;

 private:
  struct Kind {
    std::uint64_t places{};
    std::uint64_t bytes{};
    std::uint64_t first{};
    bool placed{};
  };
  std::map<std::string, Kind> kinds_;
};

}  // namespace fathom::recordings
