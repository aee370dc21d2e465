/// app/render/embed_shaders_main.cpp: build tool. embed_shaders SHADER_FOLDER VARIANT_FOLDER OUT
///   Writes every variant as the driver will see it (for the validator) and the sources as one C++ file. Exit 0 done, 2 on any error of the files, CLI11's code on wrong usage.
#include <CLI/CLI.hpp>
#include <fstream>
#include <iostream>

#include "app/render/shader_source.h"

namespace {

using burrhole::Status;

Status write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  out << text;
  out.flush();
  if (!out) return burrhole::bad_input("cannot write", path.string());
  return {};
}

Status write_variant(const burrhole::ShaderFiles& files, const burrhole::ShaderVariant& variant, const std::filesystem::path& folder) {
  for (const auto& [file, extension] : {std::pair(variant.vertex, ".vert"), std::pair(variant.fragment, ".frag")}) {
    const auto text = burrhole::expand_shader(files, file, variant.defines);
    if (!text) return text.error();
    const Status written = write_text(folder / (variant.name + extension), text.value());
    if (!written) return written;
  }
  return {};
}

std::string embedded_source(const burrhole::ShaderFiles& files) {
  std::string out = "#include \"app/render/shader_source.h\"\n\nnamespace burrhole {\n\nconst ShaderFiles& embedded_shaders() {\n";
  out += "  static const ShaderFiles files{\n";
  for (const auto& [name, text] : files) out += "      {\"" + name + "\", R\"glsl(" + text + ")glsl\"},\n";
  return out + "  };\n  return files;\n}\n\n}  // namespace burrhole\n";
}

Status embed(const std::filesystem::path& shaders, const std::filesystem::path& variants, const std::filesystem::path& out) {
  const auto files = burrhole::read_shader_folder(shaders);
  if (!files) return files.error();
  for (const burrhole::ShaderVariant& variant : burrhole::all_shader_variants()) {
    const Status written = write_variant(files.value(), variant, variants);
    if (!written) return written;
  }
  return write_text(out, embedded_source(files.value()));
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Expands every shader variant and embeds the sources.", "embed_shaders"};
  std::string shaders, variants, out;
  app.add_option("SHADER_FOLDER", shaders, "folder of the GLSL sources")->required();
  app.add_option("VARIANT_FOLDER", variants, "folder to write the expanded variants into")->required();
  app.add_option("OUT", out, "C++ file to write")->required();
  CLI11_PARSE(app, argc, argv);
  const Status done = embed(shaders, variants, out);
  if (!done) std::cerr << done.error().text() << '\n';
  return done ? 0 : 2;
}
