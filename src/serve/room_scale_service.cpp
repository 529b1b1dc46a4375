#include "serve/room_scale_service.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "io/json_text.h"
#include "room/room_json.h"
#include "room/room_scale.h"
#include "serve/plain_run.h"

namespace aligngs {
namespace {

using Json = nlohmann::json;

constexpr const char* kScaleRemedy =
    R"(send {"from": [x, y, z], "to": [x, y, z], "metres": length}, or {"reset": true})";

Vec3d place_in(const Json& json, const char* field) {
  const auto found = json.find(field);
  Vec3d place;
  if (found == json.end() || !found->is_array() || found->size() != 3)
    throw_bad_input({}, field, "is no list of three numbers", kScaleRemedy);
  for (int k = 0; k < 3; ++k) {
    const Json& number = (*found)[static_cast<size_t>(k)];
    if (!number.is_number()) throw_bad_input({}, field, "is no list of three numbers", kScaleRemedy);
    place[k] = number.get<double>();
  }
  if (!std::isfinite(dot(place, place))) throw_bad_input({}, field, "is not finite", kScaleRemedy);
  return place;
}

MeasuredRoom scaled_room(const MeasuredRoom& before, const Json& asked) {
  const auto length = asked.find("metres");
  const Vec3d from = place_in(asked, "from"), to = place_in(asked, "to");
  if (length == asked.end() || !length->is_number()) throw_bad_input({}, "metres", "is no number", kScaleRemedy);
  return scaled_between(before, from, to, length->get<double>());
}

}  // namespace

void serve_scale(const std::filesystem::path& run, std::function<MeasuredRoom(const MeasuredRoom&)> without_given,
                 ViewServerOptions& options) {
  options.post["/api/scale"] = [run, without_given = std::move(without_given)](const std::string& body) -> std::string {
    const Json asked = parse_json(body);
    if (!asked.is_object()) throw_bad_input({}, "", "the request is no JSON object", kScaleRemedy);
    require_plain_run(run);
    const std::filesystem::path file = run / "room.json";
    if (!std::filesystem::exists(file))
      throw_usage("this run has no room.json, which keeps its scale", "aligngs room RUN makes it");
    const MeasuredRoom before = read_room(file);
    const MeasuredRoom after =
        asked.value("reset", Json()) == true ? without_given(before) : scaled_room(before, asked);
    return json_line(Json{{"factor", write_scale(file, before, after)}});
  };
}

}  // namespace aligngs
