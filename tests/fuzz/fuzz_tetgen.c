/* What stands before the first '%' is the file of nodes, the rest that of elements. */
#include "fuzz.h"

#include "mesh/generate.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    ShvMesh mesh;
    ShvError error = {SHV_OK, ""};
    const uint8_t *split = size > 0 ? memchr(data, '%', size) : NULL;
    const size_t first = split ? (size_t)(split - data) : size, rest = split ? size - first - 1 : 0;
    const char *nodes = fuzz_path(".node"), *elements = fuzz_path(".ele");
    fuzz_write(nodes, data, first);
    fuzz_write(elements, split ? split + 1 : data, rest);
    const ShvStatus status = shv_mesh_read_tetgen(&mesh, NULL, nodes, &error);
    fuzz_judge(status, &error);
    if (status == SHV_OK) shv_mesh_release(&mesh);
    unlink(nodes);
    unlink(elements);
    return 0;
}
