/* fuzz_obj: meshes in Wavefront's text format. */
#include "input.h"
#include "files/obj.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    fuzz_mesh(bis_obj_read, data, size);
    fuzz_mesh(bis_obj_read_uv, data, size);
    return 0;
}
