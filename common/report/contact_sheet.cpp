#include "common/report/contact_sheet.hpp"

#include "common/report/page_parts.hpp"
#include "common/report/text.hpp"

namespace fathom::report {

std::string base64(std::span<const std::uint8_t> bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto byte = [&](std::size_t k) -> unsigned { return k < bytes.size() ? bytes[k] : 0U; };
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = bytes.size() - i;
    const unsigned three = byte(i) << 16U | byte(i + 1) << 8U | byte(i + 2);
    text += kDigits[three >> 18U];
    text += kDigits[three >> 12U & 63U];
    text += left > 1 ? kDigits[three >> 6U & 63U] : '=';
    text += left > 2 ? kDigits[three & 63U] : '=';
  }
  return text;
}

std::string contact_sheet(std::span<const Camera> pictures, Utime origin) {
  if (pictures.empty()) return {};
  std::string html =
      "<section><h2>What the camera saw</h2><p class=\"small soft\">Green: tags that were used, with their number and "
      "axes; red: tags that were refused, and why. Yellow arrows: features from the picture before to this one, grey "
      "those that did not agree. Magenta: where the laser's dot can be, and where it was found.</p><div "
      "class=\"grid\">";
  for (const Camera& each : pictures) {
    const std::string when = number(seconds_between(origin, each.utime), 4) + " s";
    html += figure("<img alt=\"" + escape(each.camera) + " at " + when + "\" width=\"" + std::to_string(each.width) +
                       "\" height=\"" + std::to_string(each.height) + "\" src=\"data:image/jpeg;base64," +
                       base64(each.jpeg) + "\">",
                   when);
  }
  return html + "</div></section>\n";
}

}  // namespace fathom::report
