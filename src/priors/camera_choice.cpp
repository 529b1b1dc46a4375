#include "priors/camera_choice.h"

#include <fmt/format.h>

#include "core/error.h"
#include "core/progress.h"
#include "priors/model_sets.h"
#include "priors/teacher_list.h"

namespace aligngs {
namespace {

[[noreturn]] void throw_no_camera_network() {
  const auto size = [](const char* set) {
    uint64_t bytes = 0;
    for (const PublishedModel* model : models_of({set})) bytes += download_bytes(*model);
    return format_bytes(bytes);
  };
  throw Error({ErrorKind::kWeights,
               "no network that finds cameras is installed",
               {},
               "method",
               fmt::format("aligngs models download recommended   ({}), or light ({}); weights that anyone may use",
                           size("recommended"), size("light"))});
}

/// The method's own weights, or the best installed ones of the method that anyone may use where those are missing.
std::string best_weights_of_method(PosesMethod method, const ModelStore& store) {
  const std::string own = default_camera_teacher(method).model;
  if (store.installed(published_model(own))) return own;
  for (const Teacher* teacher : camera_teachers()) {
    const PublishedModel& model = published_model(teacher->model);
    if (method_of(*teacher) == method && model.licence.is_for_anyone() && store.installed(model)) return model.name;
  }
  return own;
}

/// The named weights, else the method's best.
std::string weights_of_method(const CameraRequest& request, PosesMethod method, const ModelStore& store) {
  if (request.model.empty()) return best_weights_of_method(method, store);
  const Teacher* const named = find_camera_teacher(request.model);
  if (named && method_of(*named) == method) return request.model;
  throw_usage(fmt::format("{} is no network of --method {}", request.model, word_of(method)),
              named ? fmt::format("with it goes --method {}", word_of(method_of(*named)))
                    : "see `aligngs poses --help` for the weights");
}

/// Options of one method go with no other.
void require_options_of(PosesMethod method, const CameraRequest& request) {
  if (!request.cameras.empty() && method != PosesMethod::kGiven)
    throw_usage("--cameras goes with --method given", "add --method given, or leave --cameras out");
  if (request.camera_from_rays && method != PosesMethod::kDa3)
    throw_usage("--camera-from-rays goes with --method da3", "add --method da3, or leave --camera-from-rays out");
  if (request.metres == MetresChoice::kNetwork && method != PosesMethod::kDa3)
    throw_usage("--metres goes with --method da3", "add --method da3, or leave --metres out");
}

CameraChoice choice_of(const CameraRequest& request, const ModelStore& store) {
  if (request.method == PosesMethod::kColmap)
    return {PosesMethod::kColmap, "", "the program COLMAP finds the cameras", false};
  if (request.method == PosesMethod::kGiven) return {PosesMethod::kGiven, "", "the cameras are given", false};
  if (request.method != PosesMethod::kAuto) {
    const std::string model = weights_of_method(request, request.method, store);
    return {request.method, model, model + " finds the cameras, as asked for", false};
  }
  if (!request.cameras.empty()) return {PosesMethod::kGiven, "", "the cameras are given", false};
  if (request.model.empty() && (request.camera_from_rays || request.metres == MetresChoice::kNetwork)) {
    const std::string model = best_weights_of_method(PosesMethod::kDa3, store);
    return {PosesMethod::kDa3, model, model + " finds the cameras: an option asks for da3", false};
  }
  if (!request.model.empty()) {
    const Teacher* const named = find_camera_teacher(request.model);
    if (!named) throw_usage(request.model + " finds no cameras", "see `aligngs poses --help` for the weights");
    return {method_of(*named), request.model, request.model + " finds the cameras, as asked for", false};
  }
  const Teacher* const best = installed_camera_teacher(store);
  if (!best) throw_no_camera_network();
  return {method_of(*best), best->model, fmt::format("cameras by {}: {}", best->model, best->cameras.reason), true};
}

}  // namespace

PosesMethod poses_method(const std::string& word) {
  if (const std::optional<PosesMethod> method = choice_named<PosesMethod>(word)) return *method;
  throw_usage("\"" + word + "\" is no method that finds cameras", "see `aligngs poses --help` for the methods");
}

CameraChoice choose_cameras(const CameraRequest& request, const ModelStore& store) {
  CameraChoice choice = choice_of(request, store);
  require_options_of(choice.method, request);
  return choice;
}

const PublishedModel* installed_camera_network(const CameraRequest& request, const ModelStore& store) {
  std::string model = request.model;
  if (is_camera_network_method(request.method))
    model = weights_of_method(request, request.method, store);
  else if (model.empty()) {
    const Teacher* const best = installed_camera_teacher(store);
    if (!best) return nullptr;
    model = best->model;
  }
  const PublishedModel& published = published_model(model);
  return store.installed(published) ? &published : nullptr;
}

std::string terms_of_choice(const PublishedModel& model, const char* purpose) {
  const ModelLicence& licence = model.licence;
  if (licence.is_for_anyone()) return {};
  return fmt::format("{} by {}, as no other network for them is installed: licence {}, {}", purpose, model.name,
                     licence.id, licence.question.empty() ? licence.note : licence.question);
}

}  // namespace aligngs
