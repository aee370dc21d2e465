#include "app/report/html.h"

#include <cstdint>
#include <filesystem>

#include "app/report/file.h"
#include "core/config/toml_messages.h"

namespace burrhole {
namespace {

constexpr const char* kStyle = R"(
:root { color-scheme: light; }
body { margin: 0 auto; max-width: 60rem; padding: 1.5rem 1.25rem 3rem; background: #fff; color: #222;
       font: 16px/1.5 system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; }
h1 { margin: 0; font-size: 1.7rem; line-height: 1.25; }
h2 { margin: 2.2rem 0 .6rem; font-size: 1.15rem; border-bottom: 1px solid #ddd; padding-bottom: .25rem; }
.subtitle { margin: .2rem 0 1.2rem; color: #666; }
.tiles { display: grid; grid-template-columns: repeat(auto-fit, minmax(9.5rem, 1fr)); gap: .6rem; margin: 1rem 0; }
.tile { border: 1px solid #e0dccf; border-radius: 6px; background: #faf8f3; padding: .55rem .75rem; }
.tile .name { font-size: .8rem; color: #666; }
.tile .value { font-size: 1.35rem; font-weight: 600; font-variant-numeric: tabular-nums; }
.tile .unit { font-size: .85rem; font-weight: 400; color: #666; }
.alert { border-color: #d9a199; background: #fdf1ef; }
.alert .value { color: #a3271b; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: .9rem; }
th, td { padding: .3rem .9rem .3rem 0; text-align: right; border-bottom: 1px solid #eee; white-space: nowrap;
         font-variant-numeric: tabular-nums; }
th { color: #666; font-weight: 600; }
th:first-child, td:first-child { text-align: left; white-space: normal; }
details { margin: 2.2rem 0 0; }
summary { font-size: 1.15rem; font-weight: 600; border-bottom: 1px solid #ddd; padding-bottom: .25rem; cursor: pointer; }
figure { margin: 0; }
figcaption { margin-top: .3rem; font-size: .85rem; color: #666; }
figure svg { width: 100%; height: auto; display: block; }
figure svg text { font-family: system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif; }
figure img { width: 100%; height: auto; display: block; border-radius: 4px; }
.narrow { display: none; }
.pictures { display: grid; grid-template-columns: repeat(auto-fit, minmax(17rem, 1fr)); gap: 1rem; }
@media (max-width: 42rem) {
  body { padding: .8rem .7rem 2rem; }
  .wide { display: none; }
  .narrow { display: block; }
  .tiles { grid-template-columns: repeat(auto-fit, minmax(8rem, 1fr)); }
}
@media print {
  body { max-width: none; padding: 0; font-size: 12px; }
  .tile, figure, tr { break-inside: avoid; }
  h2 { break-after: avoid; }
}
)";

constexpr std::string_view kPngSignature("\x89PNG\r\n\x1a\n", 8);

std::string element(std::string_view tag, std::string_view text) {
  return '<' + std::string(tag) + '>' + html_escape(text) + "</" + std::string(tag) + '>';
}

std::string row(const std::vector<std::string>& cells, std::string_view tag) {
  std::string out = "<tr>";
  for (const std::string& cell : cells) out += element(tag, cell);
  return out + "</tr>\n";
}

/// @returns the element of an SVG document: the XML declaration and document type before it are not valid inside a page.
std::string_view svg_element(std::string_view document) {
  const std::size_t begin = document.find("<svg");
  return begin == std::string_view::npos ? document : document.substr(begin);
}

std::string caption_element(std::string_view caption) { return caption.empty() ? std::string() : element("figcaption", caption); }

}  // namespace

std::string html_escape(std::string_view given) {
  const std::string text = printable_text(given);
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string base64(std::string_view bytes) {
  static constexpr std::string_view kLetters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t j = 0; j < 3; ++j) word = word << 8 | (i + j < bytes.size() ? static_cast<unsigned char>(bytes[i + j]) : 0u);
    for (std::size_t j = 0; j < 4; ++j) out += i + j <= bytes.size() ? kLetters[word >> (18 - 6 * j) & 63u] : '=';
  }
  return out;
}

HtmlPage::HtmlPage(std::string_view title, std::string_view subtitle) : title_(title) {
  body_ = element("h1", title) + "\n<p class=\"subtitle\">" + html_escape(subtitle) + "</p>\n";
}

void HtmlPage::heading(std::string_view text) { body_ += element("h2", text) + '\n'; }

void HtmlPage::paragraph(std::string_view text) { body_ += element("p", text) + '\n'; }

void HtmlPage::tiles(const std::vector<HtmlTile>& tiles) {
  body_ += "<div class=\"tiles\">\n";
  for (const HtmlTile& tile : tiles) {
    body_ += std::string("<div class=\"tile") + (tile.alert ? " alert" : "") + "\"><div class=\"name\">" + html_escape(tile.name) +
             "</div><div class=\"value\">" + html_escape(tile.value) + " <span class=\"unit\">" + html_escape(tile.unit) +
             "</span></div></div>\n";
  }
  body_ += "</div>\n";
}

void HtmlPage::table(const std::vector<std::string>& columns, const std::vector<std::vector<std::string>>& rows) {
  body_ += "<div class=\"scroll\"><table>\n<thead>" + row(columns, "th") + "</thead>\n<tbody>\n";
  for (const std::vector<std::string>& cells : rows) body_ += row(cells, "td");
  body_ += "</tbody></table></div>\n";
}

void HtmlPage::begin_details(std::string_view summary) { body_ += "<details>" + element("summary", summary) + '\n'; }

void HtmlPage::end_details() { body_ += "</details>\n"; }

void HtmlPage::svg(std::string_view document, std::string_view caption) {
  body_ += "<figure>" + std::string(svg_element(document)) + caption_element(caption) + "</figure>\n";
}

void HtmlPage::svg(std::string_view wide, std::string_view narrow, std::string_view caption) {
  body_ += "<figure><div class=\"wide\">" + std::string(svg_element(wide)) + "</div><div class=\"narrow\">" +
           std::string(svg_element(narrow)) + "</div>" + caption_element(caption) + "</figure>\n";
}

Status HtmlPage::picture(const std::string& png_path, std::string_view caption) {
  const Result<std::string> bytes = read_file(png_path);
  if (!bytes) return bytes.error();
  if (!bytes->starts_with(kPngSignature)) return bad_input("is not a PNG picture", png_path);
  const std::string file = std::filesystem::path(png_path).filename().string();
  body_ += "<figure><a href=\"" + html_escape(file) + "\"><img alt=\"" + html_escape(caption) + "\" src=\"data:image/png;base64," +
           base64(*bytes) + "\"></a>" + caption_element(caption) + "</figure>\n";
  return {};
}

void HtmlPage::begin_pictures() { body_ += "<div class=\"pictures\">\n"; }

void HtmlPage::end_pictures() { body_ += "</div>\n"; }

std::string HtmlPage::text() const {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n" +
         element("title", title_) + "\n<style>" + kStyle + "</style>\n</head>\n<body>\n" + body_ + "</body>\n</html>\n";
}

}  // namespace burrhole
