#include <fmt/format.h>

#include "io/atomic_file.h"
#include "room/plan/plan_files.h"

namespace aligngs {
namespace {

struct LayerStyle {
  double width;  // mm on paper
  const char* color;
};

LayerStyle style_of(PlanLayer layer) {
  switch (layer) {
    case PlanLayer::kWalls:
      return {0.7, "#000000"};
    case PlanLayer::kOpenings:
      return {0.25, "#1f5fa8"};
    case PlanLayer::kFurniture:
      return {0.25, "#7a5c2e"};
    case PlanLayer::kDimensions:
      return {0.13, "#444444"};
    case PlanLayer::kText:
      return {0.25, "#000000"};
  }
  return {0.25, "#000000"};
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (static_cast<unsigned char>(c) >= 0x20)
      out += c;
  }
  return out;
}

}  // namespace

std::string plan_svg(const PlanDrawing& drawing, const PlanSettings& settings) {
  const double width = (drawing.high.x - drawing.low.x) / settings.scale,
               height = (drawing.high.y - drawing.low.y) / settings.scale;
  // Paper has y downwards.
  const auto paper = [&](const Vec2d& p) {
    return Vec2d{(p.x - drawing.low.x) / settings.scale, (drawing.high.y - p.y) / settings.scale};
  };
  std::string out = fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.2f}mm\" "
      "height=\"{1:.2f}mm\" "
      "viewBox=\"0 0 {0:.2f} {1:.2f}\">\n<title>Floor plan 1:{2:.0f}</title>\n<rect width=\"100%\" height=\"100%\" "
      "fill=\"#ffffff\"/>\n",
      width, height, settings.scale);
  for (const PlanLayer layer : kPlanLayers) {
    const LayerStyle style = style_of(layer);
    out += fmt::format(
        "<g id=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-linecap=\"square\" "
        "stroke-linejoin=\"miter\">\n",
        name_of(layer), style.color, style.width);
    for (const PlanPath& path : drawing.paths) {
      if (path.layer != layer) continue;
      out += path.closed ? "<polygon points=\"" : "<polyline points=\"";
      for (const Vec2d& point : path.points) {
        const Vec2d p = paper(point);
        out += fmt::format("{:.3f},{:.3f} ", p.x, p.y);
      }
      out.back() = '"';
      out += path.dashed ? " stroke-dasharray=\"1.5 1.5\"/>\n" : "/>\n";
    }
    for (const PlanText& text : drawing.texts) {
      if (text.layer != layer) continue;
      const Vec2d p = paper(text.place);
      out += fmt::format(
          "<text transform=\"translate({:.3f} {:.3f}) rotate({:.2f})\" font-family=\"sans-serif\" font-size=\"{:.2f}\" "
          "fill=\"{}\" stroke=\"none\"{}>{}</text>\n",
          p.x, p.y, text.turn == 0 ? 0 : -text.turn, text.height / settings.scale * 1.4, style.color,
          text.anchor == PlanAnchor::kMiddle ? " text-anchor=\"middle\"" : "", escaped(text.text));
    }
    out += "</g>\n";
  }
  return out + "</svg>\n";
}

const std::vector<PlanFormat>& plan_format_rows() {
  static const std::vector<PlanFormat> rows = {
      {"plan.svg", "the floor plan to scale, a page of vectors", plan_svg},
      {"plan.dxf", "the floor plan in millimetres, for CAD",
       [](const PlanDrawing& drawing, const PlanSettings&) { return plan_dxf(drawing); }},
      {"plan.pdf", "the floor plan to scale, a page to print", plan_pdf}};
  return rows;
}

void write_plan(const std::filesystem::path& file, const PlanFormat& format, const MeasuredRoom& room,
                const PlanSettings& settings) {
  write_file_atomically(file, format.draw(draw_plan(room, settings), settings));
}

}  // namespace aligngs
