#include <fmt/format.h>

#include <cmath>

#include "core/angles.h"
#include "room/plan/plan_files.h"

namespace aligngs {
namespace {

constexpr double kPoints = 72 / 25.4;  // per millimetre of paper
// of the font size, mean of Helvetica's digits and small letters: to centre a text
constexpr double kHelveticaWidth = 0.52;

double width_of(PlanLayer layer) {
  return layer == PlanLayer::kWalls ? 0.7 : layer == PlanLayer::kDimensions ? 0.13 : 0.25;
}

/// Latin-1 with the characters that PDF strings escape; others become '?'.
std::string latin(const std::string& utf8, size_t& letters) {
  std::string out;
  letters = 0;
  for (size_t i = 0; i < utf8.size(); ++i) {
    const unsigned char c = static_cast<unsigned char>(utf8[i]);
    if (c < 0x20 || (c & 0xc0) == 0x80) continue;
    ++letters;
    if (c == '(' || c == ')' || c == '\\') out += '\\';
    if (c < 0x80) {
      out += static_cast<char>(c);
    } else if ((c == 0xc2 || c == 0xc3) && i + 1 < utf8.size()) {
      out += fmt::format("\\{:03o}", (c & 0x1f) << 6 | (static_cast<unsigned char>(utf8[i + 1]) & 0x3f));
    } else {
      out += '?';
    }
  }
  return out;
}

std::string page_of(const PlanDrawing& drawing, const PlanSettings& settings) {
  const double scale = kPoints / settings.scale;
  const auto page = [&](const Vec2d& p) { return Vec2d{(p.x - drawing.low.x) * scale, (p.y - drawing.low.y) * scale}; };
  std::string out = "2 J\n";
  for (const PlanPath& path : drawing.paths) {
    out += fmt::format("{:.2f} w [{}] 0 d\n", width_of(path.layer) * kPoints, path.dashed ? "4 4" : "");
    for (size_t i = 0; i < path.points.size(); ++i) {
      const Vec2d p = page(path.points[i]);
      out += fmt::format("{:.3f} {:.3f} {}\n", p.x, p.y, i == 0 ? 'm' : 'l');
    }
    out += path.closed ? "s\n" : "S\n";
  }
  for (const PlanText& text : drawing.texts) {
    size_t letters = 0;
    const std::string bytes = latin(text.text, letters);
    const double size = text.height * scale * 1.4, c = std::cos(text.turn * kRadiansPerDegree),
                 s = std::sin(text.turn * kRadiansPerDegree);
    Vec2d p = page(text.place);
    const double back =
        text.anchor == PlanAnchor::kMiddle ? kHelveticaWidth * size * static_cast<double>(letters) / 2 : 0;
    p = {p.x - back * c, p.y - back * s};
    out += fmt::format("BT /F1 {:.2f} Tf {:.5f} {:.5f} {:.5f} {:.5f} {:.3f} {:.3f} Tm ({}) Tj ET\n", size, c, s, -s, c,
                       p.x, p.y, bytes);
  }
  return out;
}

}  // namespace

std::string plan_pdf(const PlanDrawing& drawing, const PlanSettings& settings) {
  const std::string page = page_of(drawing, settings);
  const double width = (drawing.high.x - drawing.low.x) / settings.scale * kPoints,
               height = (drawing.high.y - drawing.low.y) / settings.scale * kPoints;
  const std::vector<std::string> objects = {
      "<< /Type /Catalog /Pages 2 0 R >>", "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
      fmt::format("<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {:.2f} {:.2f}] /Contents 4 0 R /Resources << /Font << "
                  "/F1 5 0 R >> >> >>",
                  width, height),
      fmt::format("<< /Length {} >>\nstream\n{}endstream", page.size(), page),
      "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica /Encoding /WinAnsiEncoding >>"};
  std::string out = "%PDF-1.4\n";
  std::vector<size_t> places;
  for (size_t i = 0; i < objects.size(); ++i) {
    places.push_back(out.size());
    out += fmt::format("{} 0 obj\n{}\nendobj\n", i + 1, objects[i]);
  }
  const size_t table = out.size();
  out += fmt::format("xref\n0 {}\n0000000000 65535 f \n", objects.size() + 1);
  for (const size_t place : places) out += fmt::format("{:010} 00000 n \n", place);
  return out + fmt::format("trailer\n<< /Size {} /Root 1 0 R >>\nstartxref\n{}\n%%EOF\n", objects.size() + 1, table);
}

}  // namespace aligngs
