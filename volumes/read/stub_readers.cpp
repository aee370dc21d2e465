// The readers that test_volumes_read_scan does not call, so that it links without them.
#include "volumes/read/scan.h"

namespace burrhole {

Result<ReadScan> read_mesh_scan(const std::string& path, const ReadOptions&) { return bad_input("meshes are not linked here", path); }
Result<ReadScan> read_foreign_vdb(const std::string& path, const ReadOptions&) { return bad_input("OpenVDB is not linked here", path); }

}  // namespace burrhole
