#include "plot/map_svg.h"

#include "base/escape.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

namespace hardbody {
namespace {

// Lengths in pixels.
constexpr double kWidth = 760;
constexpr double kHeight = 540;
constexpr double kLeft = 70;
constexpr double kRight = 30;
constexpr double kTop = 50;
constexpr double kBottom = 60;
constexpr double kMargin = 0.03;  ///< fraction of the data's range, on either side

constexpr std::array<const char*, 6> kColours = {"#1f4e9c", "#c23b22", "#2e7d32", "#7b1fa2", "#b26a00", "#00695c"};
constexpr std::array<const char*, 6> kDashes = {"", "7 4", "2 3", "9 3 2 3", "", "4 2"};

std::string svg_text(const std::string& text) {
  constexpr Escape kEscapes[] = {{'&', "&amp;"}, {'<', "&lt;"}};
  return escaped(text, kEscapes);
}

/// Returns the text with what follows an underscore, up to a space, below the line.
std::string with_index(const std::string& text) {
  const std::size_t cut = text.find('_');
  if (cut == std::string::npos) return svg_text(text);
  const std::size_t end = std::min(text.find(' ', cut), text.size());
  std::string svg = svg_text(text.substr(0, cut)) + "<tspan dy=\"4\" font-size=\"10\">" +
                    svg_text(text.substr(cut + 1, end - cut - 1)) + "</tspan>";
  if (end < text.size()) svg += "<tspan dy=\"-4\">" + svg_text(text.substr(end)) + "</tspan>";
  return svg;
}

/// Returns 1, 2 or 5 times a power of ten, about a sixth of the range.
double tick_step(double range) {
  const double power = std::pow(10.0, std::floor(std::log10(range / 6)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (range / (factor * power) <= 7.5) return factor * power;
  }
  return 10 * power;
}

/// Axis: maps data to pixels.
class Scale {
 public:
  Scale(double low, double high, double from, double to, bool log) : from_(from), to_(to), log_(log) {
    low_ = inner(low);
    high_ = inner(high);
    const double margin = high_ > low_ ? kMargin * (high_ - low_) : 0.5;
    low_ -= margin;
    high_ += margin;
  }

  double at(double x) const { return from_ + (to_ - from_) * (inner(x) - low_) / (high_ - low_); }

  std::vector<double> ticks() const {
    std::vector<double> list;
    if (log_) {
      for (int power = static_cast<int>(std::floor(low_)); power <= high_; ++power) {
        for (const double digit : {1.0, 2.0, 3.0, 5.0}) list.push_back(digit * std::pow(10.0, power));
      }
    } else {
      const double step = tick_step(high_ - low_);
      for (double k = std::ceil(low_ / step); k * step <= high_; ++k) list.push_back(k * step);
    }
    std::erase_if(list, [&](double x) { return inner(x) < low_ || inner(x) > high_; });
    return list;
  }

 private:
  double inner(double x) const { return log_ ? std::log10(x) : x; }

  double from_;
  double to_;
  bool log_;
  double low_;
  double high_;
};

/// Returns the scale of an axis; there is at least one mark.
Scale scale_of(const Map& map, double MapMark::*coordinate, double from, double to, bool log) {
  const auto [low, high] =
      std::minmax_element(map.marks.begin(), map.marks.end(),
                          [&](const MapMark& a, const MapMark& b) { return a.*coordinate < b.*coordinate; });
  return {(*low).*coordinate, (*high).*coordinate, from, to, log};
}

class Drawing {
 public:
  explicit Drawing(const Map& map)
      : map_(map),
        x_(scale_of(map, &MapMark::x, kLeft, kWidth - kRight, map.scales.log_x)),
        y_(scale_of(map, &MapMark::y, kHeight - kBottom, kTop, map.scales.log_y)) {}

  std::string text() {
    add("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
        "font-family=\"sans-serif\" font-size=\"13\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
        kWidth, kHeight);
    axes();
    for (const MapMark& mark : map_.marks) {
      circle(x_.at(mark.x), y_.at(mark.y), mark.open);
    }
    for (const MapLevel& level : map_.levels) lines(level);
    legend();
    return text_ + "</svg>\n";
  }

 private:
  template <class... Arguments>
  void add(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
  }

  void axes() {
    add("<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"black\"/>\n", kLeft, kTop,
        kWidth - kLeft - kRight, kHeight - kTop - kBottom);
    for (const double tick : x_.ticks()) {
      add("<path d=\"M{0:.1f} {1}v-6\" stroke=\"black\"/><text x=\"{0:.1f}\" y=\"{2}\" "
          "text-anchor=\"middle\">{3:g}</text>\n",
          x_.at(tick), kHeight - kBottom, kHeight - kBottom + 18, tick);
    }
    for (const double tick : y_.ticks()) {
      add("<path d=\"M{0} {1:.1f}h6\" stroke=\"black\"/><text x=\"{2}\" y=\"{3:.1f}\" "
          "text-anchor=\"end\">{4:g}</text>\n",
          kLeft, y_.at(tick), kLeft - 7, y_.at(tick) + 4.5, tick);
    }
    add("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\" font-size=\"15\">{}</text>\n", (kLeft + kWidth - kRight) / 2,
        kHeight - 18, svg_text(map_.x_label));
    add("<text transform=\"translate(20 {}) rotate(-90)\" text-anchor=\"middle\" font-size=\"15\">{}</text>\n",
        (kTop + kHeight - kBottom) / 2, svg_text(map_.y_label));
  }

  void circle(double x, double y, bool open) {
    add("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{}\" fill=\"{}\" stroke=\"{}\"/>\n", x, y, open ? 2.8 : 1.8,
        open ? "white" : "#888", open ? "#555" : "#888");
  }

  static const char* colour(std::size_t of) { return kColours[of % kColours.size()]; }
  static const char* dashes(std::size_t of) { return kDashes[of % kDashes.size()]; }

  void lines(const MapLevel& level) {
    for (const ContourLine& line : level.lines) {
      add("<path fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\" stroke-dasharray=\"{}\" d=\"", colour(level.of),
          dashes(level.of));
      const char* command = "M";
      for (const PlanePoint& p : line) {
        add("{}{:.1f} {:.1f}", command, x_.at(p.x), y_.at(p.y));
        command = "L";
      }
      add("\"/>\n");
      label(level, line);
    }
  }

  /// Writes the label at the line's highest point.
  void label(const MapLevel& level, const ContourLine& line) {
    if (line.size() < 3) return;
    const PlanePoint& top =
        *std::max_element(line.begin(), line.end(), [](const PlanePoint& a, const PlanePoint& b) { return a.y < b.y; });
    add("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\" font-size=\"11\" fill=\"{}\" stroke=\"white\" "
        "stroke-width=\"3\" paint-order=\"stroke\">{:g}</text>\n",
        x_.at(top.x), y_.at(top.y) - 3, colour(level.of), level.level);
  }

  void legend() {
    double at = kLeft;
    for (std::size_t of = 0; of < map_.legend.size(); ++of) {
      add("<path d=\"M{:.1f} 28h30\" stroke=\"{}\" stroke-width=\"1.6\" stroke-dasharray=\"{}\"/>"
          "<text x=\"{:.1f}\" y=\"32.5\">{}</text>\n",
          at, colour(of), dashes(of), at + 36, with_index(map_.legend[of]));
      at += 60 + 8 * static_cast<double>(map_.legend[of].size());
    }
    if (std::none_of(map_.marks.begin(), map_.marks.end(), [](const MapMark& mark) { return mark.open; })) return;
    circle(at + 4, 28, true);
    add("<text x=\"{:.1f}\" y=\"32.5\">not shown to be equilibrated</text>\n", at + 14);
  }

  const Map& map_;
  Scale x_;
  Scale y_;
  std::string text_;
};

}  // namespace

std::string map_svg(const Map& map) {
  return Drawing(map).text();
}

}  // namespace hardbody
