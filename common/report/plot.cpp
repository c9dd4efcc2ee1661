// Runs gnuplot once for all figures of a page, in a folder of its own, and tidies the SVG that it writes.
#include "common/report/plot.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "common/base/error.hpp"
#include "common/report/text.hpp"

namespace fathom::report {
namespace {

namespace fs = std::filesystem;

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (fs::temp_directory_path() / "fathom-report-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) {
      throw InputError(pattern + ": cannot make a temporary folder; check TMPDIR and free space");
    }
    path_ = pattern;
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

std::string contents(const fs::path& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string screen(int pixels, int of) { return std::to_string(static_cast<double>(pixels) / of); }

// The look that all pictures share.
std::string frame(const Figure& f, std::size_t index, const fs::path& svg) {
  std::ostringstream s;
  s << "reset session\nset encoding utf8\nset terminal svg size " << f.width << "," << f.height
    << " dynamic noenhanced rounded font 'sans-serif,12' name 'f" << index << "'\nset output " << quoted(svg.string())
    << "\nunset key\nset border 3 lc rgb '#8a8f98'\nset tics nomirror in scale 0.5 textcolor rgb '#444b55'\n"
    << "set grid lc rgb '#e4e7eb' lt 1 lw 1\nset format '%g'\nset style fill solid 1.0 noborder\nset errorbars 0\n"
    << "set lmargin at screen " << screen(f.left, f.width) << "\nset rmargin at screen "
    << screen(f.width - f.right, f.width) << "\nset bmargin at screen " << screen(f.bottom, f.height)
    << "\nset tmargin at screen " << screen(f.height - f.top, f.height) << "\n";
  return s.str();
}

void run(const std::string& program, const fs::path& script, const fs::path& complaints) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, complaints.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  std::string name = program;
  std::string defaults = "--default-settings";  // nobody's ~/.gnuplot may change the pictures
  std::string file = script.string();
  char* arguments[] = {name.data(), defaults.data(), file.data(), nullptr};
  pid_t child = 0;
  const int failure = posix_spawnp(&child, name.c_str(), &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  int status = 0;
  while (failure == 0 && waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  // Where it shows only in the child (POSIX), as it does under an emulator, that ends with this code.
  constexpr int kNotStarted = 127;
  if (failure != 0 || (WIFEXITED(status) && WEXITSTATUS(status) == kNotStarted)) {
    throw InputError(program +
                     ": cannot be started, so the report has no pictures; install it: apt-get install gnuplot-nox");
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    std::string said = contents(complaints);
    const std::string line = join(wrap(said, 300), " ").substr(0, 300);
    throw InputError(program +
                     ": drawing the report failed; check that gnuplot 5.4 with the svg terminal works: " + line);
  }
}

void replace_all(std::string& text, const std::string& from, const std::string& to) {
  for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

void erase_between(std::string& text, const std::string& begin, const std::string& end) {
  const std::size_t from = text.find(begin);
  const std::size_t to = text.find(end, from);
  if (from != std::string::npos && to != std::string::npos) text.erase(from, to + end.size() - from);
}

// gnuplot opens a group for each change of pen, most of them stay empty: a third of the file.
std::string without_empty_groups(const std::string& svg) {
  std::istringstream lines(svg);
  std::string kept;
  std::string held;
  for (std::string line; std::getline(lines, line);) {
    if (!held.empty() && line == "</g>") {
      held.clear();
      continue;
    }
    kept += held;
    held.clear();
    if (line.starts_with("<g ") && line.ends_with(">") && line.find("id=") == std::string::npos) {
      held = line + "\n";
    } else if (!line.empty()) {
      kept += line + "\n";
    }
  }
  return kept + held;
}

std::string tidy(std::string svg, const Figure& figure, std::size_t index) {
  const std::size_t root = svg.find("<svg");
  const std::size_t inside = svg.find('>', root);
  if (inside == std::string::npos) throw InputError("gnuplot: wrote no SVG; check that its svg terminal works");
  svg.erase(0, inside + 1);
  erase_between(svg, "<title>", "</title>");
  erase_between(svg, "<desc>", "</desc>");
  const std::string defs_end = "</defs>";
  const std::size_t body = svg.find(defs_end);
  if (body != std::string::npos && svg.find("'#gp", body) == std::string::npos) {
    erase_between(svg, "<defs>", defs_end);
  } else {
    erase_between(svg, "<filter id='textbox'", "</filter>");
    erase_between(svg, "<filter id='greybox'", "</filter>");
  }
  const std::string prefix = "f" + std::to_string(index);
  for (const char* quote : {"'", "'#"}) {
    replace_all(svg, std::string(quote) + "gp", std::string(quote) + prefix + "gp");
  }
  replace_all(svg, " id=\"gnuplot_canvas\"", "");
  return "<svg viewBox=\"0 0 " + std::to_string(figure.width) + " " + std::to_string(figure.height) +
         "\" role=\"img\" aria-label=\"" + escape(figure.alt) + "\">" + without_empty_groups(svg);
}

}  // namespace

std::string quoted(std::string text) {
  replace_all(text, "'", "''");
  replace_all(text, "\n", " ");
  return "'" + text + "'";
}

std::vector<std::string> render(const std::vector<Figure>& figures, const std::string& gnuplot) {
  if (figures.empty()) return {};
  const TemporaryFolder folder;
  const fs::path script = folder.path() / "figures.gp";
  const auto svg = [&](std::size_t i) { return folder.path() / (std::to_string(i) + ".svg"); };
  {
    std::ofstream file(script);
    for (std::size_t i = 0; i < figures.size(); ++i) {
      file << frame(figures[i], i, svg(i)) << figures[i].script << "\nunset output\n";
    }
    if (!file.flush()) throw InputError(script.string() + ": cannot be written; check TMPDIR and free space");
  }
  run(gnuplot, script, folder.path() / "complaints");
  std::vector<std::string> pictures;
  for (std::size_t i = 0; i < figures.size(); ++i) pictures.push_back(tidy(contents(svg(i)), figures[i], i));
  return pictures;
}

std::string svg_file(const Figure& figure) {
  std::string svg = render({figure}).front();
  const std::size_t inside = svg.find('>') + 1;
  svg.insert(inside, "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>");
  svg.insert(svg.find(' '), " xmlns=\"http://www.w3.org/2000/svg\" width=\"" + std::to_string(figure.width) +
                                "\" height=\"" + std::to_string(figure.height) + "\"");
  return svg;
}

}  // namespace fathom::report
