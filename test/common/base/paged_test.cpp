// A long sequence on disk gives what a short one in memory gives, and takes no more memory.
#include "common/base/paged.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <string>

#include "common/base/error.hpp"

namespace fathom {
namespace {

constexpr std::size_t kLong = 2 * Paged<double>::kInMemory + 1234;

/// Resident memory, kB.
long resident() {
  std::ifstream status{"/proc/self/status"};
  for (std::string word; status >> word;) {
    if (word != "VmRSS:") continue;
    long size = 0;
    status >> size;
    return size;
  }
  return 0;
}

Paged<double> counted(std::size_t count) {
  Paged<double> all;
  all.reserve(count);
  for (std::size_t i = 0; i < count; ++i) all.push_back(0.5 * static_cast<double>(i));
  return all;
}

}  // namespace

TEST_CASE("paged: every value of a long sequence is where it was put, forwards, backwards and beside the one before") {
  for (const std::size_t count : {std::size_t{3}, Paged<double>::kInMemory, Paged<double>::kInMemory + 1, kLong}) {
    CAPTURE(count);
    const Paged<double> all = counted(count);
    REQUIRE(all.size() == count);
    bool right = true;
    for (std::size_t i = 1; i < count; ++i)
      right = right && all[i] == 0.5 * static_cast<double>(i) && all[i - 1] == 0.5 * static_cast<double>(i - 1);
    for (std::size_t i = count; i-- > 0;) right = right && all[i] == 0.5 * static_cast<double>(i);
    CHECK(right);
    CHECK(all.front() == 0.0);
    CHECK(all.back() == 0.5 * static_cast<double>(count - 1));
    CHECK(std::ranges::is_sorted(all));
    CHECK(*std::ranges::lower_bound(all, 1.0) == 1.0);
    CHECK(std::ranges::count_if(all, [](double value) { return value < 1.0; }) == 2);
  }
}

TEST_CASE("paged: what is changed is changed everywhere, and grows on") {
  Paged<double> all = counted(kLong);
  CHECK(all[1] == 0.5);  // a page that is kept must not be read again as it was
  all.change([](double& value) { value *= 4.0; });
  all.push_back(7.0);
  CHECK(all[1] == 2.0);
  CHECK(all[kLong - 1] == 2.0 * static_cast<double>(kLong - 1));
  CHECK(all[kLong] == 7.0);
  const Paged<double> moved = std::move(all);
  CHECK(moved[Paged<double>::kPage + 1] == 2.0 * static_cast<double>(Paged<double>::kPage + 1));
}

TEST_CASE("paged: ten million values take the memory of half a million") {
  const long before = resident();
  const Paged<double> all = counted(10'000'000);  // 80 MB
  CHECK(std::ranges::is_sorted(all));
#ifndef __SANITIZE_ADDRESS__  // which keeps what was freed
  CHECK(resident() - before < 20'000);
#endif
  CHECK(before > 0);
}

TEST_CASE("paged: a folder that is none is refused with what to do") {
  const char* stated = std::getenv("TMPDIR");
  const std::string before = stated == nullptr ? "" : stated;
  ::setenv("TMPDIR", "/no/such/folder", 1);
  std::string said;
  try {
    const Paged<double> all = counted(kLong);
  } catch (const InputError& error) {
    said = error.what();
  }
  before.empty() ? ::unsetenv("TMPDIR") : ::setenv("TMPDIR", before.c_str(), 1);
  CHECK_MESSAGE(said.starts_with("/no/such/folder: "), said);
  CHECK(said.find("in TMPDIR") != std::string::npos);
}

}  // namespace fathom
