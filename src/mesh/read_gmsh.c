/* Gmsh's MSH files: 2.2 as text, 4.1 as text and in binary of this machine's byte order. Nodes, elements and physical volumes are
   read; all other sections are skipped. */
#include <math.h>
#include <string.h>

#include "mesh/draft.h"
#include "mesh/generate.h"

enum { TET = 4, VOLUME = 3 };

/* Version 4.1 tells of volumes, and not of their tets, in which physical group they are. */
typedef struct Volume {
    int32_t tag, group;
} Volume;

typedef struct Gmsh {
    ShvScan scan;
    ShvDraft draft;
    bool version_4;
    bool has_nodes, has_elements;
    Volume *volumes; /* those that are in a group */
    int64_t volume_count;
} Gmsh;

/* Nodes of the element types that are kept (4) or skipped without loss; 0: a volume of another shape, a curved
   element or something unknown. */
static int nodes_of_type(int64_t type)
{
    switch (type) {
    case 15:
        return 1; /* point */
    case 1:
        return 2; /* line */
    case 2:
        return 3; /* triangle */
    case 3:
        return 4; /* quadrangle */
    case TET:
        return 4;
    default:
        return 0;
    }
}

static ShvStatus refuse_type(const Gmsh *gmsh, int64_t type, ShvError *error)
{
    if (nodes_of_type(type)) return SHV_OK;
    return shv_scan_fail(&gmsh->scan, error,
                         "elements of type %lld are not supported; mesh the volume with linear tets "
                         "(type 4, order 1) alone",
                         (long long)type);
}

static ShvStatus next_line(Gmsh *gmsh, const char *what, ShvError *error)
{
    if (shv_scan_record(&gmsh->scan)) return SHV_OK;
    return shv_scan_fail(&gmsh->scan, error, "the file ends where %s was expected", what);
}

static ShvStatus expect_word(Gmsh *gmsh, const char *text, ShvError *error)
{
    ShvWord word = {0};
    SHV_TRY(next_line(gmsh, text, error));
    if (shv_scan_word(&gmsh->scan, &word) && shv_word_is(word, text)) return shv_scan_end_line(&gmsh->scan, error);
    return shv_scan_fail(&gmsh->scan, error, "expected %s, not '%s'; are the counts before it right?", text,
                         shv_word_show(word).text);
}

/* ---- numbers as text or bytes, one interface ------------------------------------------------------------ */

static ShvStatus cut_off(const Gmsh *gmsh, const char *what, ShvError *error)
{
    return shv_scan_fail(&gmsh->scan, error, "the file ends within %s; it is cut off", what);
}

static ShvStatus read_whole(Gmsh *gmsh, const char *what, int64_t *value, ShvError *error)
{
    if (!gmsh->scan.binary) return shv_scan_whole(&gmsh->scan, what, 0, INT64_MAX, value, error);
    uint64_t number;
    const unsigned char *bytes = shv_scan_bytes(&gmsh->scan, sizeof number);
    if (!bytes) return cut_off(gmsh, what, error);
    memcpy(&number, bytes, sizeof number);
    if (number > INT64_MAX) return shv_scan_fail(&gmsh->scan, error, "%s is too large", what);
    *value = (int64_t)number;
    return SHV_OK;
}

/* Entity tags, the only other integers, may be negative. */
static ShvStatus read_int(Gmsh *gmsh, const char *what, int64_t *value, ShvError *error)
{
    if (!gmsh->scan.binary) return shv_scan_whole(&gmsh->scan, what, INT32_MIN, INT32_MAX, value, error);
    int32_t number;
    const unsigned char *bytes = shv_scan_bytes(&gmsh->scan, sizeof number);
    if (!bytes) return cut_off(gmsh, what, error);
    memcpy(&number, bytes, sizeof number);
    *value = number;
    return SHV_OK;
}

static ShvStatus read_coordinate(Gmsh *gmsh, double *value, ShvError *error)
{
    if (!gmsh->scan.binary) return shv_scan_number(&gmsh->scan, "a coordinate", value, error);
    const unsigned char *bytes = shv_scan_bytes(&gmsh->scan, sizeof *value);
    if (!bytes) return cut_off(gmsh, "a coordinate", error);
    memcpy(value, bytes, sizeof *value);
    if (!isfinite(*value)) return shv_scan_fail(&gmsh->scan, error, "a coordinate is not finite");
    return SHV_OK;
}

/* Text has one entry a line; bytes follow each other. */
static ShvStatus next_entry(Gmsh *gmsh, const char *what, ShvError *error)
{
    return gmsh->scan.binary ? SHV_OK : next_line(gmsh, what, error);
}

static int64_t place(const Gmsh *gmsh)
{
    return gmsh->scan.binary ? (int64_t)gmsh->scan.at : gmsh->scan.line;
}

/* ---- version 2.2 ------------------------------------------------------------------------------------------ */

static ShvStatus read_nodes_2(Gmsh *gmsh, ShvError *error)
{
    int64_t count;
    SHV_TRY(next_line(gmsh, "the number of nodes", error));
    SHV_TRY(read_whole(gmsh, "the number of nodes", &count, error));
    SHV_TRY(shv_scan_check_count(&gmsh->scan, count, 8, "nodes", error));
    for (int64_t i = 0; i < count; i++) {
        int64_t tag;
        double x[3];
        SHV_TRY(next_line(gmsh, "a node", error));
        SHV_TRY(read_whole(gmsh, "the number of a node", &tag, error));
        for (int k = 0; k < 3; k++) SHV_TRY(read_coordinate(gmsh, &x[k], error));
        SHV_TRY(shv_scan_end_line(&gmsh->scan, error));
        SHV_TRY(shv_draft_add_node(&gmsh->draft, tag, shv_load3(x), error));
    }
    return SHV_OK;
}

/* "number type tag-count tags… nodes…"; the first tag is the physical group, 0: none. */
static ShvStatus read_element_2(Gmsh *gmsh, ShvError *error)
{
    ShvDraftTet tet = {.place = place(gmsh)};
    int64_t type, tags, value;
    SHV_TRY(read_whole(gmsh, "the number of an element", &tet.tag, error));
    SHV_TRY(read_whole(gmsh, "an element type", &type, error));
    SHV_TRY(refuse_type(gmsh, type, error));
    SHV_TRY(read_whole(gmsh, "a number of tags", &tags, error));
    for (int64_t k = 0; k < tags; k++) {
        SHV_TRY(read_int(gmsh, "a tag", &value, error));
        if (k == 0) tet.group = (int32_t)value;
    }
    for (int k = 0; k < nodes_of_type(type); k++) SHV_TRY(read_whole(gmsh, "a node", &tet.nodes[k], error));
    SHV_TRY(shv_scan_end_line(&gmsh->scan, error));
    return type == TET ? shv_draft_add_tet(&gmsh->draft, &tet, error) : SHV_OK;
}

static ShvStatus read_elements_2(Gmsh *gmsh, ShvError *error)
{
    int64_t count;
    SHV_TRY(next_line(gmsh, "the number of elements", error));
    SHV_TRY(read_whole(gmsh, "the number of elements", &count, error));
    SHV_TRY(shv_scan_check_count(&gmsh->scan, count, 8, "elements", error));
    for (int64_t i = 0; i < count; i++) {
        SHV_TRY(next_line(gmsh, "an element", error));
        SHV_TRY(read_element_2(gmsh, error));
    }
    return SHV_OK;
}

/* ---- version 4.1 ------------------------------------------------------------------------------------------ */

typedef struct Block {
    int64_t dimension, entity, third; /* third: parametric (nodes), element type (elements) */
    int64_t count;
} Block;

/* "blocks entries lowest-tag highest-tag" */
static ShvStatus read_section_head(Gmsh *gmsh, int64_t *blocks, int64_t *entries, ShvError *error)
{
    int64_t ignored;
    SHV_TRY(next_entry(gmsh, "the number of blocks", error));
    SHV_TRY(read_whole(gmsh, "the number of blocks", blocks, error));
    SHV_TRY(read_whole(gmsh, "the number of entries", entries, error));
    SHV_TRY(read_whole(gmsh, "the lowest tag", &ignored, error));
    SHV_TRY(read_whole(gmsh, "the highest tag", &ignored, error));
    SHV_TRY(shv_scan_check_count(&gmsh->scan, *blocks, 7, "blocks", error));
    return shv_scan_check_count(&gmsh->scan, *entries, 2, "entries", error);
}

static ShvStatus read_block_head(Gmsh *gmsh, int64_t left, Block *block, ShvError *error)
{
    SHV_TRY(next_entry(gmsh, "a block", error));
    SHV_TRY(read_int(gmsh, "the dimension of a block", &block->dimension, error));
    SHV_TRY(read_int(gmsh, "the entity of a block", &block->entity, error));
    SHV_TRY(read_int(gmsh, "the kind of a block", &block->third, error));
    SHV_TRY(read_whole(gmsh, "the length of a block", &block->count, error));
    if (block->dimension < 0 || block->dimension > 3)
        return shv_scan_fail(&gmsh->scan, error, "a block has dimension %lld", (long long)block->dimension);
    if (block->count > left)
        return shv_scan_fail(&gmsh->scan, error, "a block of %lld entries, but only %lld of the section are left",
                             (long long)block->count, (long long)left);
    return SHV_OK;
}

/* First the tags of the block, then the coordinates. */
static ShvStatus read_node_block(Gmsh *gmsh, const Block *block, ShvError *error)
{
    const int64_t first = gmsh->draft.node_count;
    for (int64_t i = 0; i < block->count; i++) {
        int64_t tag;
        SHV_TRY(next_entry(gmsh, "a node tag", error));
        SHV_TRY(read_whole(gmsh, "a node tag", &tag, error));
        if (!gmsh->scan.binary) SHV_TRY(shv_scan_end_line(&gmsh->scan, error));
        SHV_TRY(shv_draft_add_node(&gmsh->draft, tag, shv_vec3(0.0, 0.0, 0.0), error));
    }
    for (int64_t i = 0; i < block->count; i++) {
        SHV_TRY(next_entry(gmsh, "coordinates", error));
        for (int k = 0; k < 3; k++) SHV_TRY(read_coordinate(gmsh, &gmsh->draft.positions[3 * (first + i) + k], error));
        double parameter;
        for (int64_t k = 0; block->third && k < block->dimension; k++)
            SHV_TRY(read_coordinate(gmsh, &parameter, error));
        if (!gmsh->scan.binary) SHV_TRY(shv_scan_end_line(&gmsh->scan, error));
    }
    return SHV_OK;
}

static int32_t group_of(const Gmsh *gmsh, int64_t volume)
{
    for (int64_t i = 0; i < gmsh->volume_count; i++)
        if (gmsh->volumes[i].tag == volume) return gmsh->volumes[i].group;
    return 0;
}

static ShvStatus read_element_block(Gmsh *gmsh, const Block *block, ShvError *error)
{
    SHV_TRY(refuse_type(gmsh, block->third, error));
    const int32_t group = block->dimension == VOLUME ? group_of(gmsh, block->entity) : 0;
    for (int64_t i = 0; i < block->count; i++) {
        SHV_TRY(next_entry(gmsh, "an element", error));
        ShvDraftTet tet = {.place = place(gmsh), .group = group};
        SHV_TRY(read_whole(gmsh, "an element tag", &tet.tag, error));
        for (int k = 0; k < nodes_of_type(block->third); k++)
            SHV_TRY(read_whole(gmsh, "a node tag", &tet.nodes[k], error));
        if (!gmsh->scan.binary) SHV_TRY(shv_scan_end_line(&gmsh->scan, error));
        if (block->third == TET) SHV_TRY(shv_draft_add_tet(&gmsh->draft, &tet, error));
    }
    return SHV_OK;
}

static ShvStatus read_blocks_4(Gmsh *gmsh, ShvStatus (*read)(Gmsh *, const Block *, ShvError *), ShvError *error)
{
    int64_t blocks, left;
    if (gmsh->scan.binary) shv_scan_leave_line(&gmsh->scan);
    SHV_TRY(read_section_head(gmsh, &blocks, &left, error));
    for (int64_t i = 0; i < blocks; i++) {
        Block block;
        SHV_TRY(read_block_head(gmsh, left, &block, error));
        SHV_TRY(read(gmsh, &block, error));
        left -= block.count;
    }
    if (left == 0) return SHV_OK;
    return shv_scan_fail(&gmsh->scan, error, "the blocks hold %lld entries fewer than their section announces",
                         (long long)left);
}

/* ---- physical volumes ---- */

/* "count" and lines of "dimension tag "name""; text in binary files, too. A name ends at the last quote of its line. */
static ShvStatus read_names(Gmsh *gmsh, ShvError *error)
{
    ShvScan *scan = &gmsh->scan;
    const bool binary = scan->binary;
    scan->binary = false;
    int64_t count, dimension, tag;
    SHV_TRY(next_line(gmsh, "the number of physical names", error));
    SHV_TRY(shv_scan_whole(scan, "the number of physical names", 0, INT32_MAX, &count, error));
    SHV_TRY(shv_scan_check_count(scan, count, 6, "physical names", error));
    for (int64_t i = 0; i < count; i++) {
        ShvWord word;
        ShvMeshGroup group = {0};
        SHV_TRY(next_line(gmsh, "a physical name", error));
        SHV_TRY(shv_scan_whole(scan, "a dimension", 0, 3, &dimension, error));
        SHV_TRY(shv_scan_whole(scan, "the number of a physical group", INT32_MIN, INT32_MAX, &tag, error));
        if (!shv_scan_word(scan, &word) || *word.start != '"')
            return shv_scan_fail(scan, error, "physical group %lld has no name in quotes", (long long)tag);
        const char *start = word.start + 1, *end = word.end;
        while (shv_scan_word(scan, &word)) end = word.end;
        const size_t length = (size_t)(end - start);
        if (length < 1 || end[-1] != '"' || length > sizeof group.name)
            return shv_scan_fail(scan, error,
                                 "the name of physical group %lld does not end in its line, or is longer "
                                 "than %d bytes",
                                 (long long)tag, (int)sizeof group.name - 1);
        memcpy(group.name, start, length - 1);
        group.tag = (int32_t)tag;
        if (dimension == VOLUME) SHV_TRY(shv_draft_add_group(&gmsh->draft, &group, error));
    }
    SHV_TRY(expect_word(gmsh, "$EndPhysicalNames", error));
    scan->binary = binary;
    return SHV_OK;
}

static ShvStatus add_volume(Gmsh *gmsh, int64_t tag, int64_t group, ShvError *error)
{
    const size_t count = (size_t)gmsh->volume_count + 1;
    Volume *volumes = shv_reallocate(gmsh->draft.memory, SHV_PART_MESH, gmsh->volumes, count, sizeof *volumes);
    if (!volumes) return shv_fail_memory(error, "the volumes of a mesh file", count * sizeof *volumes);
    gmsh->volumes = volumes;
    gmsh->volumes[gmsh->volume_count++] = (Volume){(int32_t)tag, (int32_t)group};
    return SHV_OK;
}

/* "tag numbers… group-count groups… bounding-count bounding…": three numbers and nothing that bounds it for a point, six for others.
   A volume of several groups is in the first. */
static ShvStatus read_entity(Gmsh *gmsh, int dimension, ShvError *error)
{
    int64_t tag, count, value, group = 0;
    double number;
    SHV_TRY(next_entry(gmsh, "an entity", error));
    SHV_TRY(read_int(gmsh, "the number of an entity", &tag, error));
    for (int k = 0; k < (dimension == 0 ? 3 : 6); k++) SHV_TRY(read_coordinate(gmsh, &number, error));
    SHV_TRY(read_whole(gmsh, "a number of physical groups", &count, error));
    for (int64_t k = 0; k < count; k++) {
        SHV_TRY(read_int(gmsh, "a physical group", &value, error));
        if (k == 0) group = value;
    }
    if (dimension == VOLUME && group != 0) SHV_TRY(add_volume(gmsh, tag, group, error));
    if (dimension > 0) SHV_TRY(read_whole(gmsh, "a number of bounding entities", &count, error));
    for (int64_t k = 0; dimension > 0 && k < count; k++) SHV_TRY(read_int(gmsh, "a bounding entity", &value, error));
    return gmsh->scan.binary ? SHV_OK : shv_scan_end_line(&gmsh->scan, error);
}

static ShvStatus read_entities(Gmsh *gmsh, ShvError *error)
{
    int64_t counts[VOLUME + 1];
    if (gmsh->scan.binary) shv_scan_leave_line(&gmsh->scan);
    SHV_TRY(next_entry(gmsh, "the numbers of entities", error));
    for (int d = 0; d <= VOLUME; d++) {
        SHV_TRY(read_whole(gmsh, "a number of entities", &counts[d], error));
        SHV_TRY(shv_scan_check_count(&gmsh->scan, counts[d], 8, "entities", error));
    }
    for (int d = 0; d <= VOLUME; d++)
        for (int64_t i = 0; i < counts[d]; i++) SHV_TRY(read_entity(gmsh, d, error));
    return expect_word(gmsh, "$EndEntities", error);
}

/* ---- the file ----------------------------------------------------------------------------------------------- */

static ShvStatus check_byte_order(Gmsh *gmsh, ShvError *error)
{
    int32_t one;
    shv_scan_leave_line(&gmsh->scan);
    const unsigned char *bytes = shv_scan_bytes(&gmsh->scan, sizeof one);
    if (!bytes) return cut_off(gmsh, "$MeshFormat", error);
    memcpy(&one, bytes, sizeof one);
    if (one == 1) return SHV_OK;
    return shv_scan_fail(&gmsh->scan, error, "the binary file is not in this machine's byte order; write it as text");
}

static ShvStatus read_format(Gmsh *gmsh, ShvError *error)
{
    ShvWord version;
    int64_t binary, size;
    SHV_TRY(expect_word(gmsh, "$MeshFormat", error));
    SHV_TRY(next_line(gmsh, "the version", error));
    if (!shv_scan_word(&gmsh->scan, &version)) return cut_off(gmsh, "$MeshFormat", error);
    gmsh->version_4 = shv_word_is(version, "4.1");
    const bool version_2 = shv_word_is(version, "2.2") || shv_word_is(version, "2.1") || shv_word_is(version, "2") ||
                           shv_word_is(version, "2.0");
    if (!gmsh->version_4 && !version_2)
        return shv_scan_fail(&gmsh->scan, error, "MSH version %s is not supported; write 2.2 (text) or 4.1",
                             shv_word_show(version).text);
    SHV_TRY(shv_scan_whole(&gmsh->scan, "the file type", 0, 1, &binary, error));
    SHV_TRY(shv_scan_whole(&gmsh->scan, "the data size", 8, 8, &size, error));
    SHV_TRY(shv_scan_end_line(&gmsh->scan, error));
    if (binary && version_2)
        return shv_scan_fail(&gmsh->scan, error,
                             "binary files of version 2 are not supported; write 4.1, or 2.2 as text");
    gmsh->scan.binary = gmsh->draft.binary = binary != 0;
    if (binary) SHV_TRY(check_byte_order(gmsh, error));
    return expect_word(gmsh, "$EndMeshFormat", error);
}

/* In a binary section the end mark could be data by chance, one in 2^80: not worth knowing every section's layout. */
static ShvStatus skip_section(Gmsh *gmsh, ShvWord name, ShvError *error)
{
    const size_t length = (size_t)(name.end - name.start) - 1;
    ShvWord word;
    while (shv_scan_record(&gmsh->scan))
        if (shv_scan_word(&gmsh->scan, &word) && (size_t)(word.end - word.start) == length + 4 &&
            memcmp(word.start, "$End", 4) == 0 && memcmp(word.start + 4, name.start + 1, length) == 0)
            return SHV_OK;
    return shv_scan_fail(&gmsh->scan, error, "section %s does not end; the file is cut off", shv_word_show(name).text);
}

static ShvStatus read_nodes(Gmsh *gmsh, ShvError *error)
{
    if (gmsh->has_nodes) return shv_scan_fail(&gmsh->scan, error, "the file has two $Nodes sections");
    gmsh->has_nodes = true;
    SHV_TRY(gmsh->version_4 ? read_blocks_4(gmsh, read_node_block, error) : read_nodes_2(gmsh, error));
    return expect_word(gmsh, "$EndNodes", error);
}

static ShvStatus read_elements(Gmsh *gmsh, ShvError *error)
{
    if (gmsh->has_elements) return shv_scan_fail(&gmsh->scan, error, "the file has two $Elements sections");
    gmsh->has_elements = true;
    SHV_TRY(gmsh->version_4 ? read_blocks_4(gmsh, read_element_block, error) : read_elements_2(gmsh, error));
    return expect_word(gmsh, "$EndElements", error);
}

static ShvStatus read_sections(Gmsh *gmsh, ShvError *error)
{
    ShvWord word;
    SHV_TRY(read_format(gmsh, error));
    while (shv_scan_record(&gmsh->scan)) {
        if (!shv_scan_word(&gmsh->scan, &word) || word.start[0] != '$' || word.end - word.start < 2)
            return shv_scan_fail(&gmsh->scan, error, "expected a section such as $Nodes, not '%s'",
                                 shv_word_show(word).text);
        if (shv_word_is(word, "$Nodes"))
            SHV_TRY(read_nodes(gmsh, error));
        else if (shv_word_is(word, "$Elements"))
            SHV_TRY(read_elements(gmsh, error));
        else if (shv_word_is(word, "$PhysicalNames"))
            SHV_TRY(read_names(gmsh, error));
        else if (gmsh->version_4 && shv_word_is(word, "$Entities"))
            SHV_TRY(read_entities(gmsh, error));
        else
            SHV_TRY(skip_section(gmsh, word, error));
    }
    if (gmsh->has_nodes && gmsh->has_elements) return SHV_OK;
    return shv_scan_fail(&gmsh->scan, error, "the file has no %s section; is it cut off?",
                         gmsh->has_nodes ? "$Elements" : "$Nodes");
}

ShvStatus shv_mesh_read_gmsh(ShvMesh *mesh, ShvMemory *memory, const char *path, ShvError *error)
{
    *mesh = (ShvMesh){0};
    Gmsh gmsh = {.draft = {.memory = memory, .path = path}};
    SHV_TRY(shv_scan_open(&gmsh.scan, memory, path, error));
    ShvStatus status = read_sections(&gmsh, error);
    shv_scan_close(&gmsh.scan);
    if (status == SHV_OK) status = shv_draft_finish(&gmsh.draft, mesh, error);
    shv_draft_release(&gmsh.draft);
    shv_release(gmsh.volumes);
    return status;
}
