// What a process knows of itself, and of another one of its name.
#include "common/runtime/self.hpp"

#include <doctest/doctest.h>

#include <fathom_lcm/health_t.hpp>
#include <vector>

namespace fathom::runtime {
namespace {

using namespace std::chrono_literals;

std::vector<std::uint8_t> health(const std::string& process, const std::string& host, std::int32_t pid,
                                 const std::string& state = "running") {
  fathom_lcm::health_t message{};
  message.process = process;
  message.host = host;
  message.pid = pid;
  message.state = state;
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

}  // namespace

TEST_CASE("twins: another process of the same name is named, and forgotten when it has gone") {
  const Twins::Clock::time_point now{100s};
  Twins twins{"estimator", "vehicle", 7};
  twins.hear(health("estimator", "vehicle", 7), now);
  twins.hear(health("identifier", "vehicle", 8), now);
  twins.hear(health("estimator", "vehicle", 9, "stopped"), now);
  twins.hear({}, now);
  CHECK(twins.complaint(now).empty());
  twins.hear(health("estimator", "topside", 7), now);
  CHECK(twins.complaint(now) == "another estimator speaks on this bus (process 7 on host topside); stop one of them");
  CHECK(twins.complaint(now + 4s).empty());
}

TEST_CASE("usage: memory is that of this process, and computing is seen") {
  Usage usage;
  CHECK(usage.measure().memory > 1'000'000);
  const auto end = std::chrono::steady_clock::now() + 50ms;
  volatile double x = 0.0;
  while (std::chrono::steady_clock::now() < end) x = x + 1.0;
  const double cpu = usage.measure().cpu;
  CHECK(cpu > 0.02);  // on a machine that twenty others compute on
  CHECK(cpu < 1.5);
}

}  // namespace fathom::runtime
