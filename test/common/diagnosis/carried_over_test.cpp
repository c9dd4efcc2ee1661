// What runs that no fit has seen say of all that was accepted together.
#include "common/diagnosis/carried_over.hpp"

#include <doctest/doctest.h>

#include <limits>

using namespace fathom;
using namespace fathom::diagnosis;

namespace {

/// A search that accepted effects which saved these shares of the training error.
SearchResult accepted(std::initializer_list<double> reductions) {
  SearchResult found;
  for (const double reduction : reductions) found.accepted.push_back({.error_reduction = reduction});
  return found;
}

}  // namespace

TEST_CASE("carried over: what training promised must show, as far as these runs can show it") {
  CHECK(carries_over(accepted({0.5}), {0.4, 0.3, 0.5}, 0.5));
  CHECK_FALSE(carries_over(accepted({0.5}), {0.05, 0.0, 0.1}, 0.5));
  CHECK(carries_over(accepted({0.5}), {0.05, 0.0, 0.1}, 0.06));              // these runs hardly feel it
  CHECK_FALSE(carries_over(accepted({0.3, 0.3}), {0.1, 0.05, 0.15}, 0.5));   // both together promised half
  CHECK_FALSE(carries_over(accepted({0.05}), {-0.03, -0.05, -0.01}, 0.02));  // harm is never kept
  CHECK(carries_over(accepted({0.5}), {std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}, 0.5));  // not judged
}

TEST_CASE("carried over: a stand-in for a small part of what is lacking is kept for what predictions gain, or not") {
  CHECK(worth_keeping(0.97, {0.01, -0.02, 0.04}));  // most of a cause needs no gain: carries_over has asked
  CHECK(worth_keeping(0.3, {0.12, 0.08, 0.16}));
  CHECK_FALSE(worth_keeping(0.3, {0.016, 0.013, 0.02}));  // surely a gain, and too little
  CHECK_FALSE(worth_keeping(0.3, {0.06, -0.01, 0.13}));   // perhaps none
  CHECK(worth_keeping(0.3, {std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}));
}
