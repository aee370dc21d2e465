/// app/report/html.h: builds a page in one file: pictures as data URIs, plots inline, plain CSS, no scripts, no external resources.
///   Errors  bad_input.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/base/result.h"

namespace burrhole {

/// @returns text escaped for elements and for double-quoted attributes, in UTF-8: other bytes and control characters become "\\xff".
[[nodiscard]] std::string html_escape(std::string_view text);

/// @returns base64 as in RFC 4648 section 4, with padding.
[[nodiscard]] std::string base64(std::string_view bytes);

/// A number with its name, shown in the row of tiles.
struct HtmlTile {
  std::string name;
  std::string value;
  std::string unit;
  bool alert = false;  ///< drawn in red: an error of the trainee
};

/// Builds the page from top to bottom. All texts are escaped here; only the output of draw_svg is inserted unchanged.
class HtmlPage {
 public:
  HtmlPage(std::string_view title, std::string_view subtitle);
  void heading(std::string_view text);
  void paragraph(std::string_view text);
  void tiles(const std::vector<HtmlTile>& tiles);
  /// The first column is text, the others are numbers (right-aligned).
  void table(const std::vector<std::string>& columns, const std::vector<std::vector<std::string>>& rows);
  /// What lies between begin and end is folded away under a line, until a reader opens it.
  void begin_details(std::string_view summary);
  void end_details();
  void svg(std::string_view document, std::string_view caption);
  /// The same plot drawn for a wide and for a narrow page; the page shows the one that fits.
  void svg(std::string_view wide, std::string_view narrow, std::string_view caption);
  /// Embeds a PNG file, with a link to the file beside the page. Errors: bad_input if it cannot be read or is not a PNG; the page is then unchanged.
  [[nodiscard]] Status picture(const std::string& png_path, std::string_view caption);
  /// Pictures between begin and end are placed side by side if there is room.
  void begin_pictures();
  void end_pictures();
  [[nodiscard]] std::string text() const;

 private:
  std::string title_;
  std::string body_;
};

}  // namespace burrhole
