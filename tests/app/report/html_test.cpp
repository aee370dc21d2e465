#include "app/report/html.h"

#include <doctest/doctest.h>

#include "app/report/file.h"
#include "tests/support/temporary_folder.h"

namespace burrhole {
namespace {

TEST_CASE("html: markup in a text is shown, never obeyed") {
  CHECK(html_escape("a\xff.toml \xc3\xa4") == "a\\xff.toml \xc3\xa4");  // a name of a file that is not UTF-8
  CHECK(html_escape("<b a=\"1\" c='2'>&</b>") == "&lt;b a=&quot;1&quot; c=&#39;2&#39;&gt;&amp;&lt;/b&gt;");
  const std::string evil = "</p><script>alert(1)</script>";
  HtmlPage page(evil, evil);
  page.heading(evil);
  page.paragraph(evil);
  page.tiles({{evil, evil, evil}});
  page.table({evil}, {{evil}});
  page.svg("<svg></svg>", evil);
  CHECK(page.text().find("<script") == std::string::npos);
}

TEST_CASE("base64: the vectors of RFC 4648 section 10") {
  CHECK(base64("") == "");
  CHECK(base64("f") == "Zg==");
  CHECK(base64("fo") == "Zm8=");
  CHECK(base64("foo") == "Zm9v");
  CHECK(base64("foob") == "Zm9vYg==");
  CHECK(base64("fooba") == "Zm9vYmE=");
  CHECK(base64("foobar") == "Zm9vYmFy");
  CHECK(base64("\xff\xfe\xfd") == "//79");
}

TEST_CASE("html: the page fetches nothing and the XML declaration of a plot stays out") {
  const TemporaryFolder folder;
  REQUIRE(write_file(folder.file("a.png"), std::string("\x89PNG\r\n\x1a\n", 8) + "rest"));
  HtmlPage page("Title", "");
  page.svg("<?xml version=\"1.0\"?>\n<!DOCTYPE svg>\n<svg></svg>", "");
  REQUIRE(page.picture(folder.file("a.png"), "a \"view\""));
  const std::string text = page.text();
  CHECK(text.find("<?xml") == std::string::npos);
  CHECK(text.find("src=\"http") == std::string::npos);
  CHECK(text.find("src=\"data:image/png;base64,iVBORw0KGgpyZXN0\"") != std::string::npos);
  CHECK(text.find("alt=\"a &quot;view&quot;\"") != std::string::npos);
}

TEST_CASE("html: a picture that is missing or no PNG is refused by name and leaves the page as it was") {
  const TemporaryFolder folder;
  REQUIRE(write_file(folder.file("fake.png"), "GIF89a"));
  HtmlPage page("Title", "");
  const std::string before = page.text();
  for (const char* name : {"fake.png", "none.png"}) {
    const Status status = page.picture(folder.file(name), "");
    REQUIRE_FALSE(status);
    CHECK(status.error().place.find(name) != std::string::npos);
  }
  CHECK(page.text() == before);
}

}  // namespace
}  // namespace burrhole
