// The sealed benchmark: draws sets, lets fathom diagnose see the data only, then opens the truth and keeps the score.
#include <CLI/CLI.hpp>
#include <cstdio>

#include "test/sealed/writing.hpp"

using namespace fathom::sealed;

int main(int argc, char** argv) {
  std::uint64_t seed = std::strtoull(argv[1], nullptr, 10);
  Wish wish;
  if (argc > 3) wish.effect = argv[3];
  if (argc > 4) wish.size = static_cast<Size>(std::atoi(argv[4]));
  const auto set = make_set(make_plan(seed, wish));
  write_set(set, places(argv[2], seed));
}
