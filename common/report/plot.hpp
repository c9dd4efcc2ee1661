// Pictures by gnuplot: figures go in as scripts, SVG elements come out, ready to stand inline on one page.
#pragma once

#include <string>
#include <vector>

namespace fathom::report {

/// One picture. The frame (fonts, grid, margins in pixels) is set before `script` runs; no key is drawn.
struct Figure {
  std::string alt;  ///< what a screen reader says
  int width{};
  int height{};
  int left{52};
  int right{12};
  int top{26};
  int bottom{47};
  std::string script{};
};

/// One SVG element per figure, with ids that do not collide as long as a page is drawn in one call.
/// InputError when `gnuplot` cannot be run or refuses a script.
[[nodiscard]] std::vector<std::string> render(const std::vector<Figure>& figures,
                                              const std::string& gnuplot = "gnuplot");

/// One figure as a file that viewers open: named as SVG and on white, which an element inside a page needs not be.
[[nodiscard]] std::string svg_file(const Figure& figure);

/// Text in gnuplot's single quotes.
[[nodiscard]] std::string quoted(std::string text);

}  // namespace fathom::report
