// fathom decode: recorded bytes of an instrument to a table: what it said, in its own units, beside what that means.
#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>
#include <vector>

#include "common/base/config.hpp"
#include "common/base/error.hpp"
#include "common/devices/protocols.hpp"
#include "common/devices/sample_fields.hpp"
#include "common/link/raw_log.hpp"
#include "common/runtime/command_line.hpp"
#include "processes/fathom/commands.hpp"

namespace fathom::tool {
namespace {

struct DecodeOptions {
  std::string protocol, file, csv, config;
};

void put_cell(std::string& line, std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) {
    line += text;
    return;
  }
  line += '"';
  for (const char c : text) {
    if (c == '"') line += '"';
    if (c != '\r' && c != '\n') line += c;
  }
  line += '"';
}

// One row per frame; the first one brings the names of the columns, which are the same for every frame.
class Table final : public devices::Output, private devices::Fields {
 public:
  Table(std::FILE* out, const devices::Protocol& protocol, const devices::Settings& settings)
      : out_{out}, protocol_{protocol}, settings_{settings} {}

  void frame(const devices::Parser& parser, const devices::Frame& frame) override {
    line_ = std::to_string(frame.offset);
    header_ = "offset";
    Fields::add("device_time_s", frame.device_time);
    parser.describe(*this);
    devices::describe_sample(frame.sample, protocol_.kind, settings_, *this);
    if (rows++ == 0) std::fprintf(out_, "%s\n", header_.c_str());
    line_ += '\n';
    std::fwrite(line_.data(), 1, line_.size(), out_);
    if (frame.sample.index() != 0) {
      ++samples;
      if (devices::marked_invalid(frame.sample)) ++invalid;
    } else if (!frame.lacks.empty()) {
      ++lacking[std::string{frame.lacks}];
    }
  }
  std::uint64_t rows{}, samples{}, invalid{};
  std::map<std::string, std::uint64_t> lacking;  ///< frames without a sample by what they lack

 private:
  void add(std::string_view name, std::string_view text) override {
    if (rows == 0) {
      header_ += ',';
      put_cell(header_, name);
    }
    line_ += ',';
    put_cell(line_, text);
  }

  std::FILE* out_;
  const devices::Protocol& protocol_;
  const devices::Settings& settings_;
  std::string line_, header_;
};

// Why good frames say nothing, the most frequent reason first.
void print_reasons(const Table& table) {
  std::vector<std::pair<std::string, std::uint64_t>> reasons{table.lacking.begin(), table.lacking.end()};
  std::stable_sort(reasons.begin(), reasons.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
  for (const auto& [reason, count] : reasons) {
    std::printf("no sample from %llu of %llu frames: %s\n", static_cast<unsigned long long>(count),
                static_cast<unsigned long long>(table.rows), reason.c_str());
  }
  if (table.invalid > 0) {
    std::printf("%llu of %llu samples are marked as not valid by the instrument\n",
                static_cast<unsigned long long>(table.invalid), static_cast<unsigned long long>(table.samples));
  }
}

void run_decode(const DecodeOptions& options) {
  const devices::Protocol& protocol = devices::protocol(options.protocol, "fathom decode");
  devices::Settings settings;
  settings.checksum_required = options.config.empty() ? false : settings.checksum_required;
  if (!options.config.empty()) {
    const Config file = Config::load(options.config);
    for (const std::string& section : file.keys()) {
      const Config driver = file.section(section);
      if (driver.has("protocol") && driver.text("protocol") == protocol.name) {
        settings = devices::read_settings(driver, protocol);
      }
    }
  }
  link::RawReader in{options.file, 0, 1.0};
  std::FILE* out = std::fopen(options.csv.c_str(), "w");
  if (out == nullptr) throw InputError(options.csv + ": cannot be written; check that the folder exists and is yours");
  const auto parser = protocol.make(settings);
  Table table{out, protocol, settings};
  while (const auto piece = in.next()) parser->feed(piece->bytes, table);
  parser->finish(table);
  if (std::fclose(out) != 0) throw InputError(options.csv + ": writing failed; is the disk full?");

  const devices::Counters& counters = parser->counters();
  const auto print = [](const char* what, std::uint64_t count) {
    std::printf("%-28s %llu\n", what, static_cast<unsigned long long>(count));
  };
  print("bytes", counters.bytes);
  print("good frames", counters.frames);
  print("samples", table.samples);
  print("bad checksums", counters.bad_checksum);
  print("bad frames", counters.bad_frame);
  print("bytes skipped", counters.skipped);
  print("bytes of a cut-off frame", counters.incomplete);
  print_reasons(table);
  if (!parser->complaint().empty()) std::printf("note: %s\n", parser->complaint().c_str());
  if (counters.frames == 0) {
    throw InputError(options.file + ": no frame of '" + options.protocol + "'; is it another protocol or baud rate?");
  }
}

}  // namespace

void add_decode(runtime::CommandLine& app) {
  auto options = std::make_shared<DecodeOptions>();
  runtime::CommandLine* command = app.add_subcommand("decode", "recorded bytes of an instrument to a table");
  std::string known = "one of:";
  for (const devices::Protocol& each : devices::protocols()) {
    known += "\n" + std::string{each.name} + ": " + std::string{each.title};
  }
  command->add_option("protocol", options->protocol, known)->required();
  command->add_option("file", options->file, "recorded bytes, bare or by a driver's 'record'")->required();
  command->add_option("--csv", options->csv, "the table: a row per frame")->required();
  command->add_option("--config", options->config, "driver's configuration: mounting and the like; left out: none");
  command->callback([options] { run_decode(*options); });
}

}  // namespace fathom::tool
