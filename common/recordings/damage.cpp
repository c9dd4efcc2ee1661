#include "common/recordings/damage.hpp"

namespace fathom::recordings {

void Damage::add(const std::string& what, std::uint64_t offset, std::uint64_t bytes) {
  Kind& kind = kinds_[what];
  if (kind.places++ == 0) kind.first = offset;
  kind.bytes += bytes;
  kind.placed = true;
}

void Damage::add(const std::string& what) { ++kinds_[what].places; }

std::uint64_t Damage::bytes() const {
  std::uint64_t sum = 0;
  for (const auto& [what, kind] : kinds_) sum += kind.bytes;
  return sum;
}

std::uint64_t Damage::places(const std::string& what) const {
  const auto found = kinds_.find(what);
  return found == kinds_.end() ? 0 : found->second.places;
}

std::vector<std::string> Damage::sentences() const {
  std::vector<std::string> all;
  for (const auto& [what, kind] : kinds_) {
    std::string text = std::to_string(kind.places) + " " + what;
    if (kind.placed)
      text += " (" + std::to_string(kind.bytes) + " bytes, the first at byte " + std::to_string(kind.first) + ")";
    all.push_back(text);
  }
  return all;
}

}  // namespace fathom::recordings
