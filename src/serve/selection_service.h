// Selections by hand for the page: kept under a name, listed, shown again, renamed and removed.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "serve/edit_service.h"

namespace aligngs {

/// A place is the number of a splat in what the page loads (CompactScene::order). Splats that nobody can see have none.
/// Bits of places are in bytes, the first place in the lowest bit, compressed as a gzip stream.
class SelectionService {
 public:
  using Shown = std::function<std::shared_ptr<const ShownSplats>(const std::string& path)>;
  /// `edits` opens the run; it must outlive the service.
  SelectionService(EditService& edits, Shown shown) : edits_(edits), shown_(std::move(shown)) {}

  /// {"selections": [{"name", "gaussians", "usable"}]}
  std::string list();
  /// {"name", "scene": path of the splats, "splats": how many the page has, as text, "places": bits in base64} -> list()
  std::string save(const std::string& request);
  std::string rename(const std::string& request);  ///< {"name", "to"} -> list()
  std::string remove(const std::string& request);  ///< {"name"} -> list()
  /// Bits of the places of a selection, by "NAME/path of the splats". Nothing for other splats than those of the run.
  std::optional<GetAnswer> places(const std::string& path);

  /// Adds GET /api/selections and /api/selections/places/, and POST /api/selections/{save,rename,remove}. The service
  /// must outlive the server.
  void serve(ViewServerOptions& options);

 private:
  EditService& edits_;
  Shown shown_;
};

}  // namespace aligngs
