// The score of all sets as a page for docs/ and its picture.
#pragma once

#include <span>
#include <string>

#include "test/sealed/judging/judge.hpp"

namespace fathom::sealed {

/// Markdown; `picture` is the file name that it shows, empty for none.
[[nodiscard]] std::string to_page(std::span<const Score> scores, const std::string& how, const std::string& picture);
/// Confusion matrix and calibration as SVG (gnuplot).
void draw_picture(std::span<const Score> scores, const std::string& path);

}  // namespace fathom::sealed
