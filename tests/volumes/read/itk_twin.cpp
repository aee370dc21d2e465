#include "tests/volumes/read/itk_twin.h"

#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

#include <stdexcept>

namespace burrhole::test {
namespace {

template <class T>
std::vector<double> values_of(const std::vector<char>& bytes, std::size_t count) {
  const T* const at = reinterpret_cast<const T*>(bytes.data());
  return {at, at + count};
}

std::vector<double> values_of(itk::CommonEnums::IOComponent type, const std::vector<char>& bytes, std::size_t count) {
  switch (type) {
    case itk::CommonEnums::IOComponent::UCHAR:
      return values_of<unsigned char>(bytes, count);
    case itk::CommonEnums::IOComponent::CHAR:
      return values_of<signed char>(bytes, count);
    case itk::CommonEnums::IOComponent::USHORT:
      return values_of<unsigned short>(bytes, count);
    case itk::CommonEnums::IOComponent::SHORT:
      return values_of<short>(bytes, count);
    case itk::CommonEnums::IOComponent::UINT:
      return values_of<unsigned int>(bytes, count);
    case itk::CommonEnums::IOComponent::INT:
      return values_of<int>(bytes, count);
    case itk::CommonEnums::IOComponent::FLOAT:
      return values_of<float>(bytes, count);
    case itk::CommonEnums::IOComponent::DOUBLE:
      return values_of<double>(bytes, count);
    default:
      throw std::runtime_error("a type that the twin does not read");
  }
}

TwinVolume read(itk::ImageIOBase& io, const std::string& path) {
  io.SetFileName(path);
  io.ReadImageInformation();
  if (io.GetNumberOfDimensions() != 3 || io.GetNumberOfComponents() != 1) throw std::runtime_error("no plain volume");
  TwinVolume out;
  itk::ImageIORegion region(3);
  std::size_t count = 1;
  for (unsigned axis = 0; axis < 3; ++axis) {
    region.SetSize(axis, io.GetDimensions(axis));
    region.SetIndex(axis, 0);
    count *= io.GetDimensions(axis);
    out.dims[axis] = static_cast<int>(io.GetDimensions(axis));
    out.spacing_mm[axis] = io.GetSpacing(axis);
    out.origin_mm[axis] = io.GetOrigin(axis);
    for (unsigned row = 0; row < 3; ++row) out.direction[axis][row] = io.GetDirection(axis)[row];
  }
  io.SetIORegion(region);
  std::vector<char> bytes(static_cast<std::size_t>(io.GetImageSizeInBytes()));
  io.Read(bytes.data());
  out.values = values_of(io.GetComponentType(), bytes, count);
  return out;
}

}  // namespace

TwinVolume read_by_itk(const std::string& path) {
  const auto ends = [&](const char* ending) { return path.ends_with(ending); };
  if (ends(".nrrd") || ends(".nhdr")) return read(*itk::NrrdImageIO::New(), path);
  if (ends(".mha") || ends(".mhd")) return read(*itk::MetaImageIO::New(), path);
  return read(*itk::NiftiImageIO::New(), path);
}

}  // namespace burrhole::test
