#include "cli/command.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { MARKDOWN, JSON };

static const struct {
    const char *key, *heading;
    double scale; /* to the heading's unit */
} columns[] = {{"density", "kg/m³", 1.0},
               {"youngs_modulus", "E, GPa", 1e-9},
               {"poissons_ratio", "ν", 1.0},
               {"loss_factor", "η", 1.0},
               {"fracture_energy", "G, J/m²", 1.0},
               {"cohesive_strength", "σ, MPa", 1e-6},
               {"cohesive_strength_shear", "τ, MPa", 1e-6},
               {"friction_angle", "φ, °", 1.0},
               {"weibull_modulus", "m", 1.0},
               {"weibull_volume", "V₀, cm³", 1e6},
               {"weibull_area", "A₀, m²", 1.0}};
enum { COLUMNS = sizeof columns / sizeof columns[0] };

static const ShvLibraryNumber *find_number(const ShvLibraryMaterial *material, const char *key)
{
    for (const ShvLibraryNumber *number = material->numbers; number->key; number++)
        if (strcmp(number->key, key) == 0) return number;
    return NULL;
}

/* Of the table: a cell of Markdown, or of a terminal. */
static void print_cell(bool markdown, const char *text)
{
    if (markdown)
        printf(" %s |", text);
    else
        shv_cli_print_padded(text, -9);
}

static void print_number(bool markdown, int digits, double value)
{
    char text[32] = "–";
    if (isfinite(value)) snprintf(text, sizeof text, "%.*g", digits, value);
    print_cell(markdown, text);
}

static void print_row(bool markdown, const ShvLibraryMaterial *entry)
{
    const ShvLibraryFigures figures = shv_library_figures(entry);
    const double unit = isfinite(figures.cohesive_zone) ? 1e3 : (double)NAN; /* mm; what cannot break has none */
    if (markdown)
        printf("| `%s` | %s |", entry->name, entry->title);
    else
        shv_cli_print_padded(entry->name, 15);
    for (int i = 0; i < COLUMNS; i++) {
        const ShvLibraryNumber *number = find_number(entry, columns[i].key);
        print_number(markdown, 4, number ? number->value * columns[i].scale : (double)NAN);
    }
    print_number(markdown, 4, figures.compressive_strength * 1e-6);
    print_number(markdown, 3, unit * figures.cohesive_zone);
    print_number(markdown, 2, unit * figures.resolved_edge);
    print_number(markdown, 3, unit * figures.snap_back);
    const char *unresolved = shv_unresolved_name(entry->unresolved);
    if (markdown)
        printf(" `%s` |", unresolved);
    else
        shv_cli_print_padded(unresolved, -14);
    if (!markdown) printf("  %s", entry->title);
    printf("\n");
}

static void print_table(bool markdown)
{
    enum { FIGURES = 4 };
    static const char *const figures[][FIGURES] = {
        {"fc, MPa", "R, mm", "h, mm", "s, mm"},
        {"fc, MPa", "cohesive zone, mm", "largest resolved edge, mm", "snap-back above, mm"}};
    static const char unresolved[] = "unresolved";
    if (markdown)
        printf("| name | material |");
    else
        shv_cli_print_padded("name", 15);
    for (int i = 0; i < COLUMNS; i++) print_cell(markdown, columns[i].heading);
    for (int i = 0; i < FIGURES; i++) print_cell(markdown, figures[markdown][i]);
    if (markdown)
        printf(" `%s` |\n|---|---|", unresolved);
    else
        shv_cli_print_padded(unresolved, -14);
    if (!markdown) printf("  material\n");
    for (int i = 0; i < COLUMNS + FIGURES + 1 && markdown; i++) printf("---|");
    if (markdown) printf("\n");
    for (int32_t i = 0; i < shv_library_count(); i++) print_row(markdown, shv_library_get(i));
    if (!markdown)
        printf("\nσ, τ: strength in tension and in shear; φ: friction angle; m: Weibull modulus; V₀, A₀: volume, "
               "surface of "
               "strength σ; fc: at which a free column\nbreaks, 2 τ tan(45° + φ/2); R: cohesive zone; h: largest mean "
               "edge that resolves it; s: longer edges snap back "
               "(docs/materials.md)\n");
}

static void print_sources(const char *heading, const char *bullet)
{
    for (int32_t i = 0; i < shv_library_count(); i++) {
        const ShvLibraryMaterial *entry = shv_library_get(i);
        printf("\n%s%s\n\n%s\n\n", heading, entry->name, entry->remark);
        for (const ShvLibraryNumber *number = entry->numbers; number->key; number++)
            printf("%s%s %.6g: %s%s\n", bullet, number->key, number->value, number->source,
                   number->unchecked ? " [source not read]" : "");
    }
}

static const char *const head =
    "# Materials\n\n"
    "This page is what `shiver materials --markdown` prints. Its numbers are those of `src/base/library.c`.\n\n"
    "```yaml\n"
    "materials:\n"
    "  glass: {library: soda_lime_glass, unresolved: scale_strength}   # any key given here goes before the library's\n"
    "```\n\n";

static const char *const formulas =
    "\n## What a mesh resolves\n\n"
    "- Cohesive zone R = (π/8) E/(1−ν²) G/σ²: the length over which a crack tip softens (the length of Dugdale and "
    "Barenblatt, in plane strain). `zone_edges` mean edges (5) have to fit into it; R over that is the largest "
    "resolved "
    "edge.\n"
    "- Snap-back: an element longer than 2 E G/σ² holds more energy at the strength than the facet beside it takes to "
    "open.\n"
    "- `shiver check` compares these lengths with the edges where the object is to break: beside `fracture.plane` "
    "where "
    "that is given; else the cohesive zone with those at the tips of notches and cracks (edges of the surface that the "
    "body goes round by more than 300 degrees); else with all of them.\n"
    "- On a coarser mesh the stress σ has to be reached half an edge h ahead of the tip, so that a tip costs about "
    "π h σ²(1−ν²)/E = (π²/8)(h/R) G. This is an estimate of size.\n\n"
    "`unresolved` says what to do then. Unless given it is the library's word, and `keep` for a material of one's own. "
    "With n = `zone_edges` and h the mean edge of the coarsest object of the "
    "material:\n\n"
    "| value | in effect | cracks begin | a crack costs |\n|---|---|---|---|\n"
    "| `keep` | σ and G as given | at σ | about (π²/8)(h/R) G at its tip |\n"
    "| `scale_strength` | σ √(R/(n h)) | too early | G |\n"
    "| `scale_energy` | G n h/R | at σ | n h/R times too much |\n"
    "| `tip_strength` | 0.62 √(E G/h) ahead of cracks, h the mean edge of the facet; σ elsewhere | at σ | about G |\n\n"
    "`tip_strength` is the one for glass, stone and ceramics on edges of millimetres (docs/glass.md, "
    "docs/evidence.md): a crack begins "
    "where "
    "the "
    "material's strength is reached and grows at its toughness. It leaves facets alone where σ is the lower of the "
    "two, and so "
    "converges to the resolved model. `scale_strength` where only growth matters and a crack is there from the "
    "start.\n\n"
    "Both scalings make R = n h; they leave resolved materials alone, and scale shear values alike. The lowered "
    "strength "
    "is the idea of A. Turon, C. G. Dávila, P. P. Camanho, J. Costa, Engineering Fracture Mechanics 74 (2007) "
    "1665-1682 (abstract read); its size follows from R ∝ 1/σ² above. Neither is the material as given: what is in "
    "effect, and "
    "whether "
    "the mesh resolves it, is printed by `shiver check`, `plan`, `run` and `info`, and stands in `/materials` of the "
    "run "
    "file.\n\n"
    "τ is the strength in shear without pressure, the cohesion. Where a friction angle φ is given, facets under a "
    "pressure p bear τ + p tan φ, and closed crack faces p tan φ (docs/cohesive.md); where none is, pressure adds "
    "nothing.\n\n"
    "m is the Weibull modulus of the strength from facet to facet, and from node to node of a surface where cracks "
    "begin (docs/glass.md): `weibull: {modulus: 0}` takes the scatter away. V₀ or A₀ is the volume or surface that has "
    "the strength σ as a "
    "whole: a facet or node has a small part V of it and so few of its flaws, and is stronger, by (V₀/V)^(1/m) in the "
    "mean. Without either every facet scatters about σ, whatever its size. `scale_strength` leaves both out. A "
    "source that is marked [source not read] was not at hand, nor another text with its number; what is called an "
    "assumption is ours, and has none. docs/sources.md says what was read, and where.\n\n"
    "A statement that results converge is possible where the zone is resolved: with plaster or this concrete, at edges "
    "below a millimetre. It is not for glass or alumina in bodies of decimetres.\n\n"
    "## Sources\n";

static void print_json(void)
{
    printf("{");
    for (int32_t i = 0; i < shv_library_count(); i++) {
        const ShvLibraryMaterial *entry = shv_library_get(i);
        const ShvLibraryFigures figures = shv_library_figures(entry);
        printf("%s", i > 0 ? ",\n " : "");
        shv_cli_print_json_text(entry->name);
        printf(": {\"breakable\": %s", entry->breakable ? "true" : "false");
        for (const ShvLibraryNumber *number = entry->numbers; number->key; number++)
            printf(", \"%s\": %.17g", number->key, number->value);
        printf(", \"unresolved\": \"%s\", \"cohesive_zone\": ", shv_unresolved_name(entry->unresolved));
        shv_cli_print_json_number(figures.cohesive_zone);
        printf(", \"resolved_edge\": ");
        shv_cli_print_json_number(figures.resolved_edge);
        printf(", \"compressive_strength\": ");
        shv_cli_print_json_number(figures.compressive_strength);
        printf("}");
    }
    printf("}\n");
}

static int run(const ShvArguments *arguments)
{
    if (arguments->values[JSON]) {
        print_json();
        return SHV_EXIT_DONE;
    }
    const bool markdown = arguments->values[MARKDOWN] != NULL;
    if (markdown) printf("%s", head);
    print_table(markdown);
    if (markdown) printf("%s", formulas);
    print_sources(markdown ? "### " : "", markdown ? "- " : "  ");
    return SHV_EXIT_DONE;
}

const ShvCommand shv_command_materials = {
    .name = "materials",
    .positional = "",
    .summary = "list the program's own materials with their sources",
    .details =
        "Prints the materials that 'library: NAME' of a scene's material takes its numbers from, the source of each\n"
        "number, the length of the cohesive zone and the largest mean edge that resolves it.",
    .options = {{"--markdown", NULL, "print docs/materials.md"}, {"--json", NULL, "print as JSON"}},
    .run = run,
};
