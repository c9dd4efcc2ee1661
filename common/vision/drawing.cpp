#include "common/vision/drawing.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <string>

namespace fathom::vision {
namespace {

const cv::Scalar kGood{80, 220, 80}, kBad{70, 70, 240}, kDot{255, 80, 255}, kFlow{0, 210, 255}, kOff{130, 130, 130},
    kText{255, 255, 255}, kShade{0, 0, 0};

constexpr int kFine = 3;  // bits of subpixel that OpenCV draws with

cv::Point fixed(const Eigen::Vector2d& p) {
  return {static_cast<int>(std::lround(p.x() * (1 << kFine))), static_cast<int>(std::lround(p.y() * (1 << kFine)))};
}

void write(cv::Mat& picture, const std::string& text, cv::Point at, double size, const cv::Scalar& colour) {
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, size, kShade, 3, cv::LINE_AA);
  cv::putText(picture, text, at, cv::FONT_HERSHEY_SIMPLEX, size, colour, 1, cv::LINE_AA);
}

void draw_tag(cv::Mat& picture, const TagSighting& tag) {
  const bool good = tag.verdict == TagVerdict::kAccepted;
  const cv::Scalar colour = good ? kGood : kBad;
  for (std::size_t i = 0; i < 4; ++i) {
    const bool seen = tag.sound[i] && tag.sound[(i + 1) % 4];
    cv::line(picture, fixed(tag.corners[i]), fixed(tag.corners[(i + 1) % 4]), seen ? colour : kOff, 1, cv::LINE_AA,
             kFine);
  }
  // The tag's own axes, as the picture shows them: x right, y down as one reads it.
  const Eigen::Vector2d middle = 0.25 * (tag.corners[0] + tag.corners[1] + tag.corners[2] + tag.corners[3]);
  cv::line(picture, fixed(middle), fixed(0.5 * (tag.corners[1] + tag.corners[2])), {60, 60, 255}, 2, cv::LINE_AA,
           kFine);
  cv::line(picture, fixed(middle), fixed(0.5 * (tag.corners[0] + tag.corners[1])), {60, 255, 60}, 2, cv::LINE_AA,
           kFine);
  const Eigen::Vector2d top = *std::min_element(tag.corners.begin(), tag.corners.end(),
                                                [](const auto& a, const auto& b) { return a.y() < b.y(); });
  const std::string text = std::to_string(tag.id) + (good ? "" : std::string{" "} + name(tag.verdict));
  write(picture, text, {static_cast<int>(top.x()) - 8, static_cast<int>(top.y()) - 6}, 0.45, colour);
}

std::string headline(const Sight& sight) {
  char text[200];
  std::string line = name(sight.picture);
  if (sight.fix) {
    const Eigen::Vector3d& p = sight.fix->pose.p_WC;
    std::snprintf(text, sizeof text, "  %d tags%s  p_WC %.2f %.2f %.2f m  %.2f px", sight.fix->n_tags,
                  sight.fix->ambiguous ? " ambiguous" : "", p.x(), p.y(), p.z(), sight.fix->rms);
    line += text;
  }
  return line;
}

std::string second_line(const Sight& sight) {
  char text[200];
  std::string line = std::string{"flow "} + name(sight.flow.state);
  if (sight.v_C) {
    const Eigen::Vector3d& v = *sight.v_C;
    std::snprintf(text, sizeof text, "  v_C %+.3f %+.3f %+.3f m/s  %d of %d", v.x(), v.y(), v.z(), sight.flow.n_agreed,
                  sight.flow.n_tracks);
    line += text;
  }
  if (sight.laser) {
    line += std::string{"  laser "} + name(sight.laser->state);
    if (sight.laser->state == LaserState::kFound) {
      std::snprintf(text, sizeof text, " %.3f m", sight.laser->p_CL.z());
      line += text;
    }
  }
  return line;
}

}  // namespace

cv::Mat draw(const Picture& picture, const FrontEnd& front_end) {
  cv::Mat drawn;
  if (picture.bgr.empty()) {
    cv::cvtColor(picture.grey, drawn, cv::COLOR_GRAY2BGR);
  } else {
    picture.bgr.copyTo(drawn);
  }
  const Sight& sight = front_end.sight();
  if (front_end.laser() != nullptr && front_end.laser()->line().size() > 1) {
    const auto& line = front_end.laser()->line();
    cv::line(drawn, fixed(line.front()), fixed(line.back()), kDot, 1, cv::LINE_AA, kFine);
  }
  for (const Track& each : front_end.tracks()) {
    cv::arrowedLine(drawn, fixed(each.from), fixed(each.to), each.agrees ? kFlow : kOff, 1, cv::LINE_AA, kFine, 0.3);
  }
  for (const TagSighting& tag : sight.tags) draw_tag(drawn, tag);
  if (sight.laser && sight.laser->state == LaserState::kFound) {
    cv::circle(drawn, fixed(sight.laser->pixel), 8 << kFine, kDot, 2, cv::LINE_AA, kFine);
  }
  write(drawn, headline(sight), {6, 16}, 0.45, kText);
  write(drawn, second_line(sight), {6, drawn.rows - 8}, 0.45, kText);
  return drawn;
}

}  // namespace fathom::vision
