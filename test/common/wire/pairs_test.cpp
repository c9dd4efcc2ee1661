// Every encode/decode pair: nothing is lost, nothing is swapped, nothing implausible comes in.
#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <fathom_lcm/camera_t.hpp>
#include <fathom_lcm/vehicle_condition_t.hpp>
#include <limits>
#include <set>
#include <tuple>

#include "common/wire/streams.hpp"
#include "test/support/filled_samples.hpp"

namespace fathom {

// All members of a plain struct; a new member makes this stop to compile until its pair was looked at.
template <std::size_t N, class T>
auto members(const T& s) {
  if constexpr (N == 2) {
    const auto& [a, b] = s;
    return std::tie(a, b);
  } else if constexpr (N == 3) {
    const auto& [a, b, c] = s;
    return std::tie(a, b, c);
  } else if constexpr (N == 4) {
    const auto& [a, b, c, d] = s;
    return std::tie(a, b, c, d);
  } else if constexpr (N == 5) {
    const auto& [a, b, c, d, e] = s;
    return std::tie(a, b, c, d, e);
  } else if constexpr (N == 6) {
    const auto& [a, b, c, d, e, f] = s;
    return std::tie(a, b, c, d, e, f);
  } else if constexpr (N == 7) {
    const auto& [a, b, c, d, e, f, g] = s;
    return std::tie(a, b, c, d, e, f, g);
  } else if constexpr (N == 8) {
    const auto& [a, b, c, d, e, f, g, h] = s;
    return std::tie(a, b, c, d, e, f, g, h);
  } else if constexpr (N == 9) {
    const auto& [a, b, c, d, e, f, g, h, i] = s;
    return std::tie(a, b, c, d, e, f, g, h, i);
  } else if constexpr (N == 13) {
    const auto& [a, b, c, d, e, f, g, h, i, j, k, l, m] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m);
  } else if constexpr (N == 10) {
    const auto& [a, b, c, d, e, f, g, h, i, j] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j);
  } else if constexpr (N == 11) {
    const auto& [a, b, c, d, e, f, g, h, i, j, k] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k);
  } else if constexpr (N == 12) {
    const auto& [a, b, c, d, e, f, g, h, i, j, k, l] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l);
  } else if constexpr (N == 14) {
    const auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n);
  } else {
    const auto& [a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p] = s;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p);
  }
}
// interval95 is not carried: it is found after a trial.
static bool operator==(const NamedValue& a, const NamedValue& b) { return members<5>(a) == members<5>(b); }
static bool operator==(const ModeMetric& a, const ModeMetric& b) { return members<3>(a) == members<3>(b); }
static bool operator==(const EffectEvidence& a, const EffectEvidence& b) { return members<5>(a) == members<5>(b); }
static bool operator==(const ChannelHealth& a, const ChannelHealth& b) { return members<3>(a) == members<3>(b); }

namespace {

template <class Message>
std::vector<std::uint8_t> bytes_of(const Message& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

template <class Message>
bool parse(const std::vector<std::uint8_t>& bytes, Message& message) {
  const int length = static_cast<int>(bytes.size());
  return message.decode(bytes.data(), 0, length) == length;
}

double number_at(const std::vector<std::uint8_t>& bytes, std::size_t at) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < 8; ++i) value = value << 8U | bytes[at + i];
  return std::bit_cast<double>(value);
}

void put_number(std::vector<std::uint8_t>& bytes, std::size_t at, double number) {
  const auto value = std::bit_cast<std::uint64_t>(number);
  for (std::size_t i = 0; i < 8; ++i) bytes[at + i] = static_cast<std::uint8_t>(value >> (56U - 8U * i));
}

// N is the number of members of the sample.
template <class Sample, std::size_t N>
void check_pair() {
  CAPTURE(wire::MessageOf<Sample>::getTypeName());
  test::Fill fill;
  Sample sample;
  test::fill(fill, sample);
  const auto bytes = bytes_of(wire::encode(sample));
  wire::MessageOf<Sample> message{};
  REQUIRE(parse(bytes, message));
  const auto back = wire::decode(message);
  REQUIRE(back.has_value());
  CHECK(members<N>(*back) == members<N>(sample));

  // Every number in turn, found by its value in the bytes, is made something that is none.
  std::size_t found = 0;
  for (std::size_t at = 8; at + 8 <= bytes.size(); ++at) {
    if (!fill.numbers().contains(number_at(bytes, at))) continue;
    ++found;
    for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL}) {
      auto damaged = bytes;
      put_number(damaged, at, bad);
      wire::MessageOf<Sample> received{};
      REQUIRE(parse(damaged, received));
      CAPTURE(at);
      CHECK_FALSE(wire::decode(received).has_value());
    }
  }
  CHECK(found == fill.numbers().size());

  // Whatever single byte is damaged or missing, decoding ends without an exception and without a huge allocation.
  for (std::size_t at = 8; at < bytes.size(); ++at) {
    for (const int value : {0x00, 0x7F, 0x80, 0xFF}) {
      auto damaged = bytes;
      damaged[at] = static_cast<std::uint8_t>(value);
      wire::MessageOf<Sample> received{};
      if (parse(damaged, received)) (void)wire::decode(received);
    }
    wire::MessageOf<Sample> received{};
    CHECK_FALSE(parse({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(at)}, received));
  }
}

template <class Sample>
auto filled_message() {
  test::Fill fill;
  Sample sample;
  test::fill(fill, sample);
  return wire::encode(sample);
}

}  // namespace

TEST_CASE("wire: every sensor sample comes back whole, and no non-finite number comes in") {
  check_pair<Ahrs, 7>();
  check_pair<Dvl, 5>();
  check_pair<Usbl, 4>();
  check_pair<Depth, 2>();
  check_pair<Ranges, 3>();
  check_pair<Loads, 2>();
  check_pair<Signal, 5>();
  check_pair<PoseCapture, 6>();
  check_pair<Battery, 2>();
  check_pair<Thrusters, 5>();
  check_pair<Camera, 5>();
  check_pair<TagPose, 6>();
  check_pair<OpticalFlow, 6>();
  check_pair<LaserRange, 4>();
}

TEST_CASE("wire: every sample of minds, commands and processes comes back whole, and no non-finite number comes in") {
  check_pair<WrenchCommand, 8>();
  check_pair<Operator, 11>();
  check_pair<Answer, 10>();
  check_pair<Excitation, 14>();
  check_pair<StateEstimate, 8>();
  check_pair<SmoothedState, 6>();
  check_pair<ModelEstimate, 12>();
  check_pair<Residual, 2>();
  check_pair<EffectRanking, 6>();
  check_pair<LearnedTold, 8>();
  check_pair<Truth, 7>();
  check_pair<Health, 16>();
  check_pair<ProcessInfo, 5>();
}

TEST_CASE("wire: flow of a negative variance is refused; the third component may say that it was not measured") {
  auto message = filled_message<OpticalFlow>();
  message.covariance[8] = -1.0;
  REQUIRE(wire::decode(message));
  CHECK_FALSE(wire::decode(message)->tells_approach());
  for (const int across : {0, 4}) {
    auto forged = message;
    forged.covariance[across] = -1e-6;
    CHECK_FALSE(wire::decode(forged));
  }
}

TEST_CASE("wire: quaternions travel as w x y z and must be unit") {
  auto message = filled_message<PoseCapture>();
  CHECK(message.q_WB[0] == doctest::Approx(1.0 / std::sqrt(30.0)));
  CHECK(message.q_WB[3] == doctest::Approx(4.0 / std::sqrt(30.0)));
  message.q_WB[0] += 0.1;
  CHECK_FALSE(wire::decode(message).has_value());
  std::fill(std::begin(message.q_WB), std::end(message.q_WB), 0.0);
  CHECK_FALSE(wire::decode(message).has_value());
}

TEST_CASE("wire: a stated length that is not the real one is refused") {
  auto ranges = filled_message<Ranges>();
  ranges.valid.pop_back();
  CHECK_FALSE(wire::decode(ranges).has_value());
  auto loads = filled_message<Loads>();
  loads.n_load = 2;
  CHECK_FALSE(wire::decode(loads).has_value());
  auto pwm = filled_message<Thrusters>();
  pwm.n_pwm = -1;
  CHECK_FALSE(wire::decode(pwm).has_value());
  auto force = filled_message<Thrusters>();
  force.force.clear();
  CHECK_FALSE(wire::decode(force).has_value());
  auto camera = filled_message<Camera>();
  camera.n_jpeg = 5;
  CHECK_FALSE(wire::decode(camera).has_value());
  auto model = filled_message<ModelEstimate>();
  model.n_effects = 4;
  CHECK_FALSE(wire::decode(model).has_value());
  auto effects = filled_message<EffectRanking>();
  effects.candidates.emplace_back();
  CHECK_FALSE(wire::decode(effects).has_value());
  auto learned = filled_message<LearnedTold>();
  learned.n_numbers = 7;
  CHECK_FALSE(wire::decode(learned).has_value());
}

TEST_CASE("wire: a length of two thousand million is refused before anything is allocated") {
  auto bytes = bytes_of(filled_message<Loads>());
  const std::size_t length_at = 16;  // behind fingerprint and utime
  for (const int high : {0x7F, 0x80}) {
    bytes[length_at] = static_cast<std::uint8_t>(high);
    fathom_lcm::loads_t message{};
    CHECK_FALSE(parse(bytes, message));
    CHECK(message.load.empty());
  }
}

TEST_CASE("wire: an abort is heard even when its unused wrench is rubbish") {
  auto message = filled_message<Operator>();
  message.abort = 1;
  message.tau[2] = std::nan("");
  const auto heard = wire::decode(message);
  REQUIRE(heard.has_value());
  CHECK(heard->abort);
  CHECK(heard->tau == Vector6d::Zero());
}

TEST_CASE("wire: a missing flag of a range means that no echo came") {
  const auto message = wire::encode(Ranges{.utime = 1, .range = {2.0, 3.0}, .valid = {1}});
  CHECK(message.valid == std::vector<std::int8_t>{1, 0});
}

TEST_CASE("wire: no two message types share a fingerprint, so lcm-spy names each rightly") {
  std::set<std::int64_t> fingerprints{
      fathom_lcm::camera_t::getHash(),          fathom_lcm::named_value_t::getHash(),
      fathom_lcm::effect_evidence_t::getHash(), fathom_lcm::mode_metric_t::getHash(),
      fathom_lcm::channel_health_t::getHash(),  fathom_lcm::vehicle_condition_t::getHash(),
      fathom_lcm::vehicle_text_t::getHash(),    fathom_lcm::condition_line_t::getHash()};
  std::size_t types = fingerprints.size();
  std::set<std::string> channels{wire::kCamera};
  const Recording empty;
  wire::visit_streams(empty, [&](const char* channel, const auto& samples) {
    using Sample = typename std::remove_cvref_t<decltype(samples)>::value_type;
    fingerprints.insert(wire::MessageOf<Sample>::getHash());
    channels.insert(channel);
    ++types;
  });
  CHECK(fingerprints.size() == types);
  CHECK(types == 34);  // as many as there are files in lcmtypes/, the two of lockstep apart
  CHECK(channels.size() == 27);
}

}  // namespace fathom
