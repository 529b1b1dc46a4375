#include "room/plan/plan_files.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>

#include "core/error.h"
#include "core/testing/shell.h"
#include "io/atomic_file.h"
#include "room/testing/sample_room.h"

namespace aligngs {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing_support::output_of;
using testing_support::runs;

std::string written(const std::string& name) {
  const fs::path file = fs::path(testing::TempDir()) / ("aligngs_" + name);
  for (const PlanFormat& format : plan_format_rows()) {
    if (format.name == name) write_plan(file, format, sample_room::make());
  }
  return file.string();
}

/// Layer to the points of its lines, read from DXF groups.
std::map<std::string, std::vector<Vec2d>> points_by_layer(const std::string& dxf) {
  std::map<std::string, std::vector<Vec2d>> out;
  std::istringstream lines(dxf);
  std::string code, value, layer;
  double x = 0;
  bool entities = false;
  while (std::getline(lines, code) && std::getline(lines, value)) {
    const int number = std::stoi(code);
    if (number == 2 && value == "ENTITIES") entities = true;
    if (!entities) continue;
    if (number == 8) layer = value;
    if (number == 10 || number == 11) x = std::stod(value);
    if (number == 20 || number == 21) out[layer].push_back({x, std::stod(value)});
  }
  return out;
}

TEST(Plan, ARoomWithoutScaleHasNone) {
  MeasuredRoom room = sample_room::make();
  room.metric = false;
  EXPECT_THROW(draw_plan(room), Error);
}

TEST(Plan, TheRemedyForAnUnknownScaleNamesWhatTheRoomHas) {
  MeasuredRoom room = sample_room::make();
  room.metric = false;
  const auto remedy = [&] {
    try {
      draw_plan(room);
    } catch (const Error& error) {
      return error.details().remedy;
    }
    return std::string();
  };
  EXPECT_THAT(remedy(), HasSubstr("--object door.1 --height 2.0"));
  room.openings.clear();
  EXPECT_THAT(remedy(), HasSubstr("--object ceiling --height 2.5"));
}

TEST(Plan, WallsHaveGapsAtDoorsAndWindows) {
  const PlanDrawing drawing = draw_plan(sample_room::make());
  double length = 0;
  for (const PlanPath& path : drawing.paths) {
    if (path.layer != PlanLayer::kWalls) continue;
    for (size_t i = 0; i + 1 < path.points.size(); ++i)
      length += std::hypot(path.points[i + 1].x - path.points[i].x, path.points[i + 1].y - path.points[i].y);
  }
  EXPECT_NEAR(length, 14000 - 900 - 1200, 1e-6);
}

TEST(Plan, AssumedWallsAreDashed) {
  const PlanDrawing drawing = draw_plan(sample_room::make());
  int dashed = 0;
  for (const PlanPath& path : drawing.paths) dashed += path.layer == PlanLayer::kWalls && path.dashed;
  EXPECT_EQ(dashed, 1);
}

TEST(Plan, AnAssumedHeightIsMarked) {
  MeasuredRoom room = sample_room::make();
  const auto marked = [&room] {
    const PlanDrawing drawing = draw_plan(room);
    return std::any_of(drawing.texts.begin(), drawing.texts.end(),
                       [](const PlanText& text) { return text.text.find("(assumed)") != std::string::npos; });
  };
  EXPECT_FALSE(marked());
  room.ceiling_assumed = true;
  EXPECT_TRUE(marked());
}

TEST(Plan, EverythingLiesInTheDrawing) {
  const PlanDrawing drawing = draw_plan(sample_room::make());
  for (const PlanPath& path : drawing.paths) {
    for (const Vec2d& p : path.points) {
      EXPECT_TRUE(p.x >= drawing.low.x && p.x <= drawing.high.x && p.y >= drawing.low.y && p.y <= drawing.high.y);
    }
  }
}

TEST(Plan, NamesDoNotCoverEachOther) {
  MeasuredRoom room = sample_room::make();
  room.boxes.push_back(room.boxes[0]);
  room.boxes.back().class_name = "bench";
  const PlanDrawing drawing = draw_plan(room);
  int names = 0;
  for (const PlanText& text : drawing.texts) names += text.layer == PlanLayer::kFurniture;
  EXPECT_EQ(names, 1);
}

TEST(Plan, TheSvgIsToScaleAndNamesItsLayers) {
  const std::string svg = plan_svg(draw_plan(sample_room::make()), {});
  for (const PlanLayer layer : kPlanLayers)
    EXPECT_THAT(svg, HasSubstr(std::string("<g id=\"") + name_of(layer) + "\""));
  EXPECT_THAT(svg, HasSubstr("12.00 m²"));
  // 4 m at 1:50 are 80 mm: the wall at y = 3 from (4, 3) to (0, 3), which has no hole.
  const PlanDrawing drawing = draw_plan(sample_room::make());
  const double left = -drawing.low.x / 50, right = (4000 - drawing.low.x) / 50;
  EXPECT_NEAR(right - left, 80, 1e-9);
  char from[32], to[32];
  std::snprintf(from, sizeof from, "%.3f,", right);
  std::snprintf(to, sizeof to, "%.3f,", left);
  EXPECT_THAT(svg, HasSubstr(from));
  EXPECT_THAT(svg, HasSubstr(to));
}

TEST(Plan, NamesFromOutsideCannotBreakTheSvg) {
  MeasuredRoom room = sample_room::make();
  room.boxes[0].class_name = "<a&b>";
  const std::string svg = plan_svg(draw_plan(room), {});
  EXPECT_THAT(svg, HasSubstr("&lt;a&amp;b&gt;"));
  EXPECT_THAT(svg, testing::Not(HasSubstr("<a&b>")));
}

TEST(Plan, TheDxfIsInMillimetresOnFiveLayers) {
  const std::string dxf = plan_dxf(draw_plan(sample_room::make()));
  auto points = points_by_layer(dxf);
  for (const PlanLayer layer : kPlanLayers) EXPECT_FALSE(points[name_of(layer)].empty()) << name_of(layer);
  double widest = 0;
  for (const Vec2d& p : points["WALLS"]) widest = std::max(widest, p.x);
  EXPECT_NEAR(widest, 4000, 1e-3);
  EXPECT_THAT(dxf, HasSubstr("12.00 m\\U+00B2"));
}

TEST(Plan, XmllintReadsTheSvg) {
  if (!runs("xmllint --version")) GTEST_SKIP() << "needs the Debian package libxml2-utils";
  EXPECT_TRUE(runs("xmllint --noout '" + written("plan.svg") + "'"));
}

TEST(Plan, LibrsvgDrawsTheSvgInItsSize) {
  if (!runs("rsvg-convert --version")) GTEST_SKIP() << "needs the Debian package librsvg2-bin";
  const std::string png = (fs::path(testing::TempDir()) / "aligngs_plan.png").string();
  ASSERT_TRUE(runs("rsvg-convert -d 254 -p 254 -o '" + png + "' '" + written("plan.svg") + "'"));
  const PlanDrawing drawing = draw_plan(sample_room::make());
  const std::string header = read_file(png).substr(16, 4);  // width, big-endian
  const int width = static_cast<unsigned char>(header[2]) * 256 + static_cast<unsigned char>(header[3]);
  EXPECT_NEAR(width, (drawing.high.x - drawing.low.x) / 50 * 10, 2) << "10 pixels a millimetre";
}

TEST(Plan, EzdxfReadsTheDxf) {
  std::string python;
  for (const char* candidate : {"python3", "/usr/bin/python3"}) {
    if (python.empty() && runs(std::string(candidate) + " -c 'import ezdxf'")) python = candidate;
  }
  if (python.empty()) GTEST_SKIP() << "needs the Debian package python3-ezdxf";
  const std::string script =
      "import ezdxf,sys; d=ezdxf.readfile(sys.argv[1]); a=d.audit(); m=d.modelspace(); "
      "print(len(a.errors), d.units, sorted(l.dxf.name for l in d.layers if l.dxf.name.isupper()), "
      "round(max(max(e.dxf.start.x,e.dxf.end.x) for e in m.query(\"LINE[layer==\\\"WALLS\\\"]\"))), "
      "len(m.query(\"TEXT\"))>5)";
  const std::string text = output_of(python + " -c '" + script + "' '" + written("plan.dxf") + "'");
  EXPECT_THAT(text, testing::StartsWith("0 4 ")) << "no errors, millimetres";
  for (const PlanLayer layer : kPlanLayers) EXPECT_THAT(text, HasSubstr(name_of(layer)));
  EXPECT_THAT(text, HasSubstr("4000 True"));
}

TEST(Plan, PopplerReadsThePdfInItsSize) {
  if (!runs("pdftotext -v")) GTEST_SKIP() << "needs the Debian package poppler-utils";
  const std::string text = output_of("pdftotext '" + written("plan.pdf") + "' -");
  EXPECT_THAT(text, HasSubstr("12.00 m²"));
  EXPECT_THAT(text, HasSubstr("sofa"));
}

}  // namespace
}  // namespace aligngs
