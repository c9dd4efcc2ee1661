// Files of arrays: MATLAB's and NumPy's. Expected numbers are those of scipy and numpy.
#include "common/recordings/arrays/arrays.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "common/base/error.hpp"
#include "common/recordings/draft.hpp"
#include "common/recordings/numpy/header.hpp"
#include "test/support/foreign_logs.hpp"
#include "test/support/heard.hpp"

namespace fathom {
namespace {

const std::string kData = std::string{FATHOM_SOURCE_DIR} + "/test/data/recordings/";

struct Figures {
  std::size_t n{};
  double least{1e300}, greatest{-1e300}, mean{};
};

Figures figures_of(const test::HeardTopic& topic, const std::string& name, std::size_t columns) {
  Figures all;
  for (std::size_t k = 0; k < columns; ++k) {
    for (const double value : topic.column(columns == 1 ? name : name + "[" + std::to_string(k) + "]")) {
      ++all.n;
      all.least = std::min(all.least, value);
      all.greatest = std::max(all.greatest, value);
      all.mean += value;
    }
  }
  all.mean /= static_cast<double>(all.n);
  return all;
}

void check(const Figures& got, std::size_t n, double least, double greatest, double mean) {
  CHECK(got.n == n);
  CHECK(got.least == doctest::Approx(least).epsilon(1e-9));
  CHECK(got.greatest == doctest::Approx(greatest).epsilon(1e-9));
  CHECK(got.mean == doctest::Approx(mean).epsilon(1e-8));
}

/// A .npy by hand.
std::string npy(const std::string& header, const std::string& data) {
  std::string text = header;
  while ((10 + text.size() + 1) % 64 != 0) text += ' ';
  text += '\n';
  return "\x93NUMPY\x01" + std::string(1, '\0') + test::packed(static_cast<std::uint16_t>(text.size())) + text + data;
}

}  // namespace

TEST_CASE("mat: a struct of rows and columns, integers, single precision, and a slower struct within") {
  const auto file = test::hear_file(kData + "beluga_log_struct.mat");
  CHECK(file.format == "mat");
  const auto& log = file.heard.of("log");
  REQUIRE(log.stamps.size() == 600);
  CHECK(log.stamps[0].log == 100'000'000);  // by t, not by the date, which resolves 10 us
  CHECK(log.stamps[599].log == 159'900'000);
  check(figures_of(log, "nu", 6), 3600, -1.95394003391, 1.93806004524, 0.00379279154017);
  check(figures_of(log, "eta", 3), 1800, -1.28112, 1.62173, 0.240710494444);
  check(figures_of(log, "quat_wxyz", 4), 2400, -0.861665, 0.99995, 0.225642007083);  // 4 x 600
  check(figures_of(log, "pwm", 8), 4800, 1276.0, 1884.0, 1575.54479167);
  CHECK(log.column("quat_wxyz[1]")[0] == doctest::Approx(0.060717));
  CHECK(log.column("nu[0]")[1] == doctest::Approx(0.236800000072));
  const auto& battery = file.heard.of("log.battery");
  REQUIRE(battery.stamps.size() == 60);
  check(figures_of(battery, "V", 1), 60, 14.131, 14.889, 14.633);
}

TEST_CASE("mat: cut in the middle: what stands before is kept, or one line says that there is nothing; no crash") {
  const std::string bytes = test::read_bytes(kData + "beluga_log_struct.mat");
  for (const std::size_t size : {bytes.size() / 2, bytes.size() - 7}) {
    CAPTURE(size);
    const std::string complaint = test::complaint_of<InputError>([&] {
      const auto file = test::hear(bytes.substr(0, size));
      if (file.damage.none()) throw InputError("nothing said");
    });
    CHECK(complaint != "nothing said");
  }
  CHECK(test::hear(bytes.substr(0, 140)).heard.topics.empty());
}

TEST_CASE("npz: numbers of all kinds, rows and columns in both orders; objects are never loaded") {
  const auto file = test::hear_file(kData + "beluga_compressed.npz");
  CHECK(file.format == "npz");
  const auto& data = file.heard.of("data");
  REQUIRE(data.stamps.size() == 600);
  CHECK(data.stamps[1].log == 100'100'000);
  check(figures_of(data, "nu", 3), 1800, -0.27349, 0.37944, 0.03425299444444444);
  check(figures_of(data, "pwm", 8), 4800, 1276.0, 1884.0, 1575.5447916666667);
  check(figures_of(data, "voltage", 1), 600, 13.3125, 14.890625, 14.6221875);
  CHECK(data.column("pwm[1]")[0] == 1497.0);
  CHECK(data.column("valid")[597] == 0.0);
  const auto objects = test::hear_file(kData + "object_array_must_refuse.npz");
  CHECK(std::ranges::any_of(objects.damage.sentences(),
                            [](const std::string& one) { return one.find("pickled") != std::string::npos; }));
}

TEST_CASE("npy: a table of its own with a date, the greatest byte first; a header that lies is refused") {
  const std::string header =
      "{'descr': [('t', '<M8[ms]'), ('u', '>f4'), ('v', '<i2', (2,))], 'fortran_order': False, 'shape': (2,), }";
  std::string rows;
  for (int i = 0; i < 2; ++i) {
    rows += test::packed(std::int64_t{1'600'000'000'000} + 100 * i);
    std::string u = test::packed(1.5F + static_cast<float>(i));
    std::reverse(u.begin(), u.end());
    rows += u + test::packed(std::int16_t{-3}, static_cast<std::int16_t>(i));
  }
  const auto file = test::hear(npy(header, rows));
  const auto& data = file.heard.of("data");
  CHECK(data.stamps[1].log == 1'600'000'000'100'000);
  CHECK(data.column("u") == std::vector<double>{1.5, 2.5});
  CHECK(data.column("v[1]") == std::vector<double>{0.0, 1.0});
  const auto refused = [](const std::string& bytes) {
    return test::complaint_of<InputError>([&] { (void)test::hear(bytes); });
  };
  CHECK(refused(npy("{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000000, 1000000000000), }", ""))
            .find("more elements") != std::string::npos);
  CHECK(refused(npy("{'descr': '<f8', 'fortran_order': False, 'shape': (10,), }", "12345678")).find("cut off") !=
        std::string::npos);
  CHECK(refused(npy("{'descr': __import__('os'), 'fortran_order': False, 'shape': (1,), }", "12345678"))
            .find("not understood") != std::string::npos);
}

TEST_CASE("arrays: the length of the time decides which side is time; what no time goes with is named") {
  using recordings::arrays::Array;
  test::Heard heard;
  recordings::Damage damage;
  const Array t{"t", {3, 1}, {738260.5, 738260.5 + 1.0 / 86400, 738260.5 + 2.0 / 86400}};
  const Array wide{"q", {2, 3}, {1, 2, 3, 4, 5, 6}};
  const Array own{"gain", {1, 7}, {1, 2, 3, 4, 5, 6, 7}};
  recordings::arrays::say({t, wide, own}, heard, damage);
  const auto& data = heard.of("data");
  CHECK(data.column("q[0]") == std::vector<double>{1, 3, 5});
  CHECK(data.column("q[1]") == std::vector<double>{2, 4, 6});
  // 738260.5 days of MATLAB are 2021-04-19 12:00, 18736.5 days after 1970.
  CHECK(data.stamps[0].log == static_cast<std::int64_t>((738260.5 - 719529.0) * 86400e6));
  CHECK(data.stamps[1].log - data.stamps[0].log == doctest::Approx(1e6).epsilon(2e-5));
  CHECK(damage.sentences().front().find("gain") != std::string::npos);
}

TEST_CASE("arrays: those with Fossen's names are drafted as what they are, others are left to a person") {
  const auto draft_of = [](const std::string& name) {
    const recordings::Files files{{kData + name}, recordings::format_of(kData + name)};
    return recordings::draft_map(recordings::read_files(files, {}, recordings::Collector::Take::kEverything));
  };
  const auto holds = [](const std::string& text, const char* words) { return text.find(words) != std::string::npos; };
  const std::string mat = draft_of("beluga_log_struct.mat");
  CAPTURE(mat);
  CHECK(holds(mat, "velocity: {columns: ['log.nu[0]', 'log.nu[1]', 'log.nu[2]'], unit: m/s, frame: FRD}"));
  CHECK(holds(mat, "rates: {columns: ['log.nu[3]', 'log.nu[4]', 'log.nu[5]'], unit: rad/s, frame: FRD}"));
  CHECK(holds(mat, "quaternion: {columns: ['log.quat_wxyz[0]', "));
  CHECK(holds(mat, "pwm: {columns: ['log.pwm[0]', "));
  CHECK(holds(mat, "column: log.battery.V"));
  CHECK_FALSE(holds(mat, "log.eta"));  // three of it: position, or position and heading?
  const std::string npz = draft_of("beluga_compressed.npz");
  CAPTURE(npz);
  CHECK(holds(npz, "rates: {columns: ['data.rates[0]', "));
  CHECK(holds(npz, "velocity: {columns: ['data.nu[0]', "));
  CHECK_FALSE(holds(npz, "quat"));  // in which order its numbers stand nobody says
  CHECK(tables::parse_streams(mat, "draft").size() == 4);
}

}  // namespace fathom
