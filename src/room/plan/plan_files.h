// Floor plans as files of other programs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "room/plan/plan_drawing.h"

namespace aligngs {

/// A page of the drawing's size at its scale: millimetres of paper, one group per layer with its name as id.
std::string plan_svg(const PlanDrawing& drawing, const PlanSettings& settings);
/// DXF of AutoCAD R12 in millimetres of the room, one layer per PlanLayer.
std::string plan_dxf(const PlanDrawing& drawing);
/// One page of the drawing's size at its scale; letters in Helvetica.
std::string plan_pdf(const PlanDrawing& drawing, const PlanSettings& settings);

/// A format of a plan as a row.
struct PlanFormat {
  const char* name;  ///< of -f, and the name of the file
  const char* help;  ///< what the file is, one line
  std::string (*draw)(const PlanDrawing& drawing, const PlanSettings& settings);
};
const std::vector<PlanFormat>& plan_format_rows();

/// Writes one of them, whole or not at all. Errors as draw_plan's.
void write_plan(const std::filesystem::path& file, const PlanFormat& format, const MeasuredRoom& room,
                const PlanSettings& settings = {});

}  // namespace aligngs
