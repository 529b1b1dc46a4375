#include "serve/web_page.h"

#include "web_assets.h"  // generated: kWebAssets

namespace aligngs {

std::span<const unsigned char> embedded_page_file(std::string_view path) {
  for (const WebAsset& asset : kWebAssets) {
    if (path == asset.path) return {asset.begin, static_cast<size_t>(asset.end - asset.begin)};
  }
  return {};
}

}  // namespace aligngs
