#include "common/base/near_name.hpp"

#include <algorithm>
#include <cctype>
#include <string>
#include <utility>
#include <vector>

namespace fathom {
namespace {

std::string folded(std::string_view key) {  // Mass, max-gap
  std::string same{key};
  for (char& c : same) c = c == '-' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return same;
}

// Letters added, lost, replaced or swapped with their neighbour (optimal string alignment).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before, last, row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    before = std::exchange(last, row);
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row[b.size()];
}

}  // namespace

// X is not Y misspelt: a short key must be nearer than a long one.
bool looks_like(std::string_view a, std::string_view b) {
  const std::size_t length = std::max(a.size(), b.size());
  return edit_distance(folded(a), folded(b)) <= (length < 3 ? 0U : length < 5 ? 1U : 2U);
}

}  // namespace fathom
