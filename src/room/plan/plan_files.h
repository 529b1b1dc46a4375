// Floor plans as files of other programs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "room/plan/plan_drawing.h"

namespace aligngs {

/// "plan.svg", "plan.dxf", "plan.pdf".
const std::vector<std::string>& plan_formats();

/// A page of the drawing's size at its scale: millimetres of paper, one group per layer with its name as id.
std::string plan_svg(const PlanDrawing& drawing, const PlanSettings& settings);
/// DXF of AutoCAD R12 in millimetres of the room, one layer per PlanLayer.
std::string plan_dxf(const PlanDrawing& drawing);
/// One page of the drawing's size at its scale; letters in Helvetica.
std::string plan_pdf(const PlanDrawing& drawing, const PlanSettings& settings);

/// Writes one of plan_formats(), whole or not at all. Errors as draw_plan's.
void write_plan(const std::filesystem::path& file, const std::string& format, const MeasuredRoom& room,
                const PlanSettings& settings = {});

}  // namespace aligngs
