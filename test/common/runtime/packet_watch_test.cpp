#include "common/runtime/packet_watch.hpp"

#include <doctest/doctest.h>

#include <vector>

namespace fathom::runtime {
namespace {

std::vector<std::uint8_t> whole(std::uint32_t number) {
  return {'L',
          'C',
          '0',
          '2',
          static_cast<std::uint8_t>(number >> 24U),
          static_cast<std::uint8_t>(number >> 16U),
          static_cast<std::uint8_t>(number >> 8U),
          static_cast<std::uint8_t>(number),
          'A',
          0,
          1};
}

std::vector<std::uint8_t> part(std::uint8_t number, std::uint8_t which, std::uint8_t of) {
  return {'L', 'C', '0', '3', 0, 0, 0, number, 0, 0, 9, 9, 0, 0, 0, 0, 0, which, 0, of, 7};
}

}  // namespace

TEST_CASE("packet watch: counts what is missing between two numbers, for each sender") {
  PacketWatch watch;
  for (const std::uint32_t number : {7U, 8U, 9U, 12U}) watch.hear(1, whole(number));
  for (const std::uint32_t number : {100U, 101U}) watch.hear(2, whole(number));
  CHECK(watch.messages() == 6);
  CHECK(watch.lost() == 2);
  CHECK(watch.senders() == 2);
  CHECK(watch.strange() == 0);
}

TEST_CASE(
    "packet watch: the numbers begin anew after the largest; a new sender on an old one's port has lost nothing") {
  PacketWatch watch;
  for (const std::uint32_t number : {0xFFFFFFFEU, 0xFFFFFFFFU, 0U, 1U}) watch.hear(1, whole(number));
  CHECK(watch.lost() == 0);
  for (const std::uint32_t number : {5000U, 5001U, 0U, 1U}) watch.hear(2, whole(number));
  CHECK(watch.lost() == 0);
}

TEST_CASE("packet watch: a message in several packets counts once, and as incomplete when one is missing") {
  PacketWatch watch;
  for (const int which : {0, 1, 2}) watch.hear(1, part(3, static_cast<std::uint8_t>(which), 3));
  CHECK(watch.messages() == 1);
  for (const int which : {0, 2}) watch.hear(1, part(4, static_cast<std::uint8_t>(which), 3));
  watch.hear(1, whole(5));
  CHECK(watch.messages() == 3);
  CHECK(watch.incomplete() == 1);
  CHECK(watch.lost() == 0);
}

TEST_CASE("packet watch: what is not LCM's is counted apart") {
  PacketWatch watch;
  watch.hear(1, std::vector<std::uint8_t>{});
  watch.hear(1, std::vector<std::uint8_t>{'L', 'C', '0', '3', 0, 0, 0, 1});
  watch.hear(1, std::vector<std::uint8_t>(30, 0));
  CHECK(watch.strange() == 3);
  CHECK(watch.messages() == 0);
}

}  // namespace fathom::runtime
