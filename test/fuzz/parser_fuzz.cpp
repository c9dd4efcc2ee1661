// Any bytes, in any pieces, through one parser: no crash, no sample that holds what is no number, all bytes accounted
// for.
#include <algorithm>
#include <cstdlib>

#include "common/devices/protocols.hpp"
#include "common/devices/sample_fields.hpp"

#ifndef FATHOM_PROTOCOL
#define FATHOM_PROTOCOL "pd0"  // the build names one per executable
#endif

namespace {

using namespace fathom;

class Nowhere final : public devices::Fields {
 public:
  void add(std::string_view, std::string_view text) override { length_ += text.size(); }

 private:
  std::size_t length_{};
};

void require(bool good) {
  if (!good) std::abort();
}

class Check final : public devices::Output {
 public:
  void frame(const devices::Parser& parser, const devices::Frame& frame) override {
    Nowhere nowhere;
    parser.describe(nowhere);
    bytes += frame.bytes.size();
    if (const auto* ahrs = std::get_if<const Ahrs*>(&frame.sample)) {
      require((*ahrs)->w_WB_B.allFinite() && (*ahrs)->f_B.allFinite() && (*ahrs)->q_WB.coeffs().allFinite());
    }
    if (const auto* dvl = std::get_if<const Dvl*>(&frame.sample)) {
      require((*dvl)->v_WB_B.allFinite() && (*dvl)->altitude >= 0.0);
    }
    if (const auto* usbl = std::get_if<const Usbl*>(&frame.sample)) require((*usbl)->p_WB.allFinite());
  }
  std::size_t bytes{};
};

}  // namespace

// NOLINTNEXTLINE(readability-identifier-naming): the name is libFuzzer's
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  static const devices::Protocol& protocol = devices::protocol(FATHOM_PROTOCOL, "fuzz");
  devices::Settings settings;
  settings.checksum_required = (data[0] & 0x80) == 0;
  settings.water_linked_axes = (data[0] & 0x40) != 0;
  const std::size_t piece = 1 + (data[0] & 0x3F) * std::size_t{7};
  const auto parser = protocol.make(settings);
  Check check;
  const devices::Bytes all{data + 1, size - 1};
  for (std::size_t at = 0; at < all.size(); at += piece) {
    parser->feed(all.subspan(at, std::min(piece, all.size() - at)), check);
  }
  parser->finish(check);
  const devices::Counters& counters = parser->counters();
  require(check.bytes + counters.line_ends + counters.skipped + counters.incomplete == counters.bytes);
  return 0;
}
