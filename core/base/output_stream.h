/// core/base/output_stream.h: an output file as the buffer of a std::ostream, for libraries that write to one. A write that fails makes the
///   stream bad, or throws where its exceptions are on.
///   Errors  kept by the file: OutputFile::commit() returns the first.   Thread  one owner.
#pragma once

#include <streambuf>

#include "core/base/output_file.h"

namespace burrhole {

class OutputStreambuf final : public std::streambuf {
 public:
  /// `file` must outlive it.
  explicit OutputStreambuf(OutputFile& file) : file_(&file) {}

 protected:
  int_type overflow(int_type byte) override {
    if (traits_type::eq_int_type(byte, traits_type::eof())) return traits_type::not_eof(byte);
    const char one = traits_type::to_char_type(byte);
    return xsputn(&one, 1) == 1 ? byte : traits_type::eof();
  }
  std::streamsize xsputn(const char* from, std::streamsize count) override {
    return file_->write(std::string_view(from, static_cast<std::size_t>(count))) ? count : 0;
  }
  /// From the beginning or from the position: writers that fill in what they know later.
  pos_type seekoff(off_type offset, std::ios_base::seekdir from, std::ios_base::openmode) override {
    const auto now = static_cast<off_type>(file_->position());
    const off_type position = from == std::ios_base::cur ? now + offset : offset;
    if (from == std::ios_base::end || position < 0) return pos_type(off_type(-1));
    if (position != now && !file_->seek(static_cast<std::uint64_t>(position))) return pos_type(off_type(-1));
    return {position};
  }
  pos_type seekpos(pos_type position, std::ios_base::openmode which) override {
    return seekoff(off_type(position), std::ios_base::beg, which);
  }

 private:
  OutputFile* file_;
};

}  // namespace burrhole
