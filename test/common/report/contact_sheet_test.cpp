// The contact sheet of a trial by pictures.
#include "common/report/contact_sheet.hpp"

#include <doctest/doctest.h>

#include <vector>

using namespace fathom;
using namespace fathom::report;

TEST_CASE("contact sheet: base64 as RFC 4648 shows it") {
  const auto of = [](const std::string& text) { return base64(std::vector<std::uint8_t>{text.begin(), text.end()}); };
  CHECK(of("").empty());
  CHECK(of("f") == "Zg==");
  CHECK(of("fo") == "Zm8=");
  CHECK(of("foo") == "Zm9v");
  CHECK(of("foobar") == "Zm9vYmFy");
  CHECK(base64(std::vector<std::uint8_t>{0xfb, 0xff, 0xfe}) == "+//+");
}

TEST_CASE("contact sheet: pictures stand in the page with their time; without pictures there is none") {
  CHECK(contact_sheet({}, 0).empty());
  const std::vector<Camera> pictures{
      {.utime = 3'500'000, .camera = "<down>", .width = 640, .height = 480, .jpeg = {'f', 'o', 'o'}}};
  const std::string html = contact_sheet(pictures, 1'000'000);
  CHECK(html.find("src=\"data:image/jpeg;base64,Zm9v\"") != std::string::npos);
  CHECK(html.find("2.500 s") != std::string::npos);
  CHECK(html.find("&lt;down&gt;") != std::string::npos);
  CHECK(html.find("<down>") == std::string::npos);
}
