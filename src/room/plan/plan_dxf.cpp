#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "room/plan/plan_files.h"

namespace aligngs {
namespace {

/// Colour numbers of AutoCAD: 7 black or white, 5 blue, 30 orange, 8 grey.
int color_of(PlanLayer layer) {
  switch (layer) {
    case PlanLayer::kWalls:
      return 7;
    case PlanLayer::kOpenings:
      return 5;
    case PlanLayer::kFurniture:
      return 30;
    case PlanLayer::kDimensions:
      return 8;
    case PlanLayer::kText:
      return 7;
  }
  return 7;
}

/// DXF is read in groups of two lines: a number that says what follows, and the value.
class Groups {
 public:
  void add(int code, const std::string& value) { text_ += fmt::format("{:>3}\n{}\n", code, value); }
  void add(int code, int value) { add(code, fmt::format("{}", value)); }
  void add(int code, double value) { add(code, fmt::format("{:.4f}", value)); }
  void place(const Vec2d& p, int first = 10) {
    add(first, p.x);
    add(first + 10, p.y);
    add(first + 20, 0.0);
  }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
};

/// Latin-1 letters as AutoCAD writes them in ASCII; others that plans do not have become '?'.
std::string ascii(const std::string& utf8) {
  std::string out;
  for (size_t i = 0; i < utf8.size(); ++i) {
    const unsigned char c = static_cast<unsigned char>(utf8[i]);
    if (c < 0x20) continue;
    if (c < 0x80) {
      out += static_cast<char>(c);
    } else if ((c & 0xe0) == 0xc0 && i + 1 < utf8.size()) {
      out += fmt::format("\\U+{:04X}", (c & 0x1f) << 6 | (static_cast<unsigned char>(utf8[i + 1]) & 0x3f));
      ++i;
    } else if ((c & 0xc0) != 0x80) {
      out += '?';
    }
  }
  return out;
}

/// `dashes`: millimetres drawn, then, negative, left out.
void add_line_type(Groups& dxf, const char* name, const char* description, const std::vector<double>& dashes) {
  double period = 0;
  for (const double dash : dashes) period += std::abs(dash);
  dxf.add(0, "LTYPE");
  dxf.add(2, name);
  dxf.add(70, 0);
  dxf.add(3, description);
  dxf.add(72, 65);
  dxf.add(73, static_cast<int>(dashes.size()));
  dxf.add(40, period);
  for (const double dash : dashes) dxf.add(49, dash);
}

void add_tables(Groups& dxf) {
  dxf.add(0, "SECTION");
  dxf.add(2, "TABLES");
  dxf.add(0, "TABLE");
  dxf.add(2, "LTYPE");
  dxf.add(70, 2);
  add_line_type(dxf, "CONTINUOUS", "Solid line", {});
  add_line_type(dxf, "DASHED", "Dashed line", {75.0, -75.0});
  dxf.add(0, "ENDTAB");
  dxf.add(0, "TABLE");
  dxf.add(2, "LAYER");
  dxf.add(70, static_cast<int>(std::size(kPlanLayers)));
  for (const PlanLayer layer : kPlanLayers) {
    dxf.add(0, "LAYER");
    dxf.add(2, name_of(layer));
    dxf.add(70, 0);
    dxf.add(62, color_of(layer));
    dxf.add(6, "CONTINUOUS");
  }
  dxf.add(0, "ENDTAB");
  dxf.add(0, "ENDSEC");
}

void add_path(Groups& dxf, const PlanPath& path) {
  const auto head = [&](const char* type) {
    dxf.add(0, type);
    dxf.add(8, name_of(path.layer));
  };
  if (path.points.size() == 2) {
    head("LINE");
    if (path.dashed) dxf.add(6, "DASHED");
    dxf.place(path.points[0]);
    dxf.place(path.points[1], 11);
    return;
  }
  head("POLYLINE");
  if (path.dashed) dxf.add(6, "DASHED");
  dxf.add(66, 1);
  dxf.place({0, 0});
  dxf.add(70, path.closed ? 1 : 0);
  for (const Vec2d& p : path.points) {
    head("VERTEX");
    dxf.place(p);
  }
  head("SEQEND");
}

}  // namespace

std::string plan_dxf(const PlanDrawing& drawing) {
  Groups dxf;
  dxf.add(0, "SECTION");
  dxf.add(2, "HEADER");
  dxf.add(9, "$ACADVER");
  dxf.add(1, "AC1009");
  dxf.add(9, "$INSUNITS");
  dxf.add(70, 4);  // millimetres
  dxf.add(9, "$EXTMIN");
  dxf.place(drawing.low);
  dxf.add(9, "$EXTMAX");
  dxf.place(drawing.high);
  dxf.add(0, "ENDSEC");
  add_tables(dxf);
  dxf.add(0, "SECTION");
  dxf.add(2, "ENTITIES");
  for (const PlanPath& path : drawing.paths) add_path(dxf, path);
  for (const PlanText& text : drawing.texts) {
    dxf.add(0, "TEXT");
    dxf.add(8, name_of(text.layer));
    dxf.place(text.place);
    dxf.add(40, text.height);
    dxf.add(1, ascii(text.text));
    if (text.turn != 0) dxf.add(50, text.turn);
    if (text.anchor == PlanAnchor::kMiddle) {
      dxf.add(72, 1);
      dxf.place(text.place, 11);
    }
  }
  dxf.add(0, "ENDSEC");
  dxf.add(0, "EOF");
  return dxf.take();
}

}  // namespace aligngs
