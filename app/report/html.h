/// app/report/html.h: one page in one file: pictures as data URIs, plots inline, plain CSS, no script, nothing fetched.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace burrhole {

/// @returns text that HTML shows as given, inside elements and inside double-quoted attributes.
[[nodiscard]] std::string html_escape(std::string_view text);

/// RFC 4648 section 4, with padding.
[[nodiscard]] std::string base64(std::string_view bytes);

/// A big number with its name, as shown in the row of tiles.
struct HtmlTile {
  std::string name;
  std::string value;
  std::string unit;
  bool alert = false;  ///< drawn in red: something went wrong
};

/// Builds the page from top to bottom. All texts are escaped here; only draw_svg's own output goes in as it is.
class HtmlPage {
 public:
  HtmlPage(std::string_view title, std::string_view subtitle);
  void heading(std::string_view text);
  void paragraph(std::string_view text);
  void tiles(const std::vector<HtmlTile>& tiles);
  /// The first column reads as text, the others as numbers (right-aligned).
  void table(const std::vector<std::string>& columns, const std::vector<std::vector<std::string>>& rows);
  void svg(std::string_view document, std::string_view caption);
  /// A PNG file goes in whole. Errors: bad_input if it cannot be read or is no PNG; the page is then unchanged.
  [[nodiscard]] Status picture(const std::string& png_path, std::string_view caption);
  /// Pictures between these two stand side by side where there is room.
  void begin_pictures();
  void end_pictures();
  [[nodiscard]] std::string text() const;

 private:
  std::string title_;
  std::string body_;
};

}  // namespace burrhole
