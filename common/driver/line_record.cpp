#include "common/driver/line_record.hpp"

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/devices/parser.hpp"
#include "common/driver/watch.hpp"
#include "common/link/link.hpp"
#include "common/runtime/process.hpp"

namespace fathom::driver {

LineRecord::LineRecord(runtime::Process& process, const Config& config) : process_{process} {
  if (config.has("record")) file_.emplace(link::free_name(config.text("record")));
}

void LineRecord::write(std::span<const std::uint8_t> bytes, Utime arrival) {
  if (!file_) return;
  try {
    file_->write(arrival, bytes);
  } catch (const InputError& error) {
    file_.reset();
    process_.log_warning(std::string{error.what()} + " No raw bytes are recorded any more");
  }
}

std::string counts(const devices::Parser& parser, const Watch& watch, const link::Link& link) {
  const devices::Counters& c = parser.counters();
  return "frames " + std::to_string(c.frames) + ", bad checksums " + std::to_string(c.bad_checksum) + ", bad frames " +
         std::to_string(c.bad_frame) + ", skipped bytes " + std::to_string(c.skipped) + ", gaps " +
         std::to_string(watch.gaps()) + ", openings " + std::to_string(link.openings());
}

}  // namespace fathom::driver
