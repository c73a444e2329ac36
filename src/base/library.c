/* The one list of the program's materials. A number is a measured one of the source it names; where it follows from other
   numbers the source says how. */
#include "shiver/library.h"

#include <string.h>

#define FLOAT_GLASS "EN 572 as quoted by VAS Glass, product data of float glass (vasglass.gr)"
#define MUNRO       "R. G. Munro, J. Am. Ceram. Soc. 80 (1997) 1919-1928; NIST SRD 150, sintered Al2O3, at 20 °C"
#define RUIZ        "G. Ruiz, A. Pandolfi, M. Ortiz, Int. J. Numer. Meth. Eng. 52 (2001) 97-120, mortar of John and Shah"
#define VEKINIS                                                                                                        \
    "handbook value of dry plaster; G. Vekinis, M. F. Ashby, P. W. R. Beaumont, J. Mater. Sci. 28 (1993) 3221 "        \
    "measure it by porosity"
#define SELES    "K. Seles et al., Procedia Structural Integrity 42 (2022) 1721-1727, Table 1"
#define EUROCODE "EN 1993-1-1, 3.2.6, as quoted by eurocodeapplied.com"

static const ShvLibraryMaterial materials[] = {
    {.name = "soda_lime_glass",
     .title = "soda-lime glass, annealed float",
     .breakable = true,
     .numbers =
         {{"density", 2500.0, FLOAT_GLASS, false},
          {"youngs_modulus", 70e9, FLOAT_GLASS, false},
          {"poissons_ratio", 0.2, FLOAT_GLASS, false},
          {"fracture_energy", 8.0,
           "twice the surface energy of 3.91 ± 0.12 J/m² of S. M. Wiederhorn, J. Am. Ceram. Soc. 52 (1969) 99-105, as "
           "tabulated by S. Reich et al., Procedia Structural Integrity 13 (2018) 28-33, rounded",
           false},
          {"cohesive_strength", 40e6,
           "tensile strength 41 MPa of annealed soda-lime glass, MakeItFrom.com, rounded; EN 572 has 45 MPa in bending",
           false},
          {"cohesive_strength_shear", 400e6,
           "assumption: ten times that in tension, as the strength in compression (about 1 GPa) suggests", true}},
     .remark = "The strength is that of panes with the scratches of use; fresh fibres bear a hundred times that."},
    {.name = "alumina",
     .title = "alumina, sintered, 99.5 % and more",
     .breakable = true,
     .numbers = {{"density", 3984.0, MUNRO, false},
                 {"youngs_modulus", 416e9, MUNRO, false},
                 {"poissons_ratio", 0.23, "1/2 − E/(6 K) with K = 257 GPa; " MUNRO, false},
                 {"fracture_energy", 27.9, "K²(1−ν²)/E with a toughness K of 3.5 MPa √m; " MUNRO, true},
                 {"cohesive_strength", 380e6, "strength in bending; " MUNRO, false}},
     .remark = "Grains of 5 µm."},
    {.name = "concrete",
     .title = "concrete (fine mortar of impact tests)",
     .breakable = true,
     .numbers = {{"density", 2400.0, RUIZ, true},
                 {"youngs_modulus", 31.37e9, RUIZ, true},
                 {"poissons_ratio", 0.2, RUIZ, true},
                 {"fracture_energy", 31.1, RUIZ, true},
                 {"cohesive_strength", 10.45e6, RUIZ, true}},
     .remark = "The strength is high; common concrete bears a few MPa and has a longer zone."},
    {.name = "plaster",
     .title = "gypsum plaster, dry",
     .breakable = true,
     .numbers = {{"density", 1200.0, VEKINIS, true},
                 {"youngs_modulus", 5e9, VEKINIS, true},
                 {"poissons_ratio", 0.2, VEKINIS, true},
                 {"fracture_energy", 10.0, VEKINIS, true},
                 {"cohesive_strength", 2.5e6, VEKINIS, true},
                 {"fracture_energy_shear", 50.0, "assumption: five times that in tension", true},
                 {"cohesive_strength_shear", 12.5e6,
                  "assumption: five times that in tension, as the strength in compression suggests", true}},
     .remark = "It varies by factors with the water it was mixed with."},
    {.name = "pmma",
     .title = "PMMA (acrylic glass)",
     .breakable = true,
     .numbers = {{"density", 1200.0, "MakeItFrom.com, PMMA", false},
                 {"youngs_modulus", 3.2043e9, SELES, false},
                 {"poissons_ratio", 0.374, SELES, false},
                 {"fracture_energy", 391.0, "K²(1−ν²)/E with a toughness K of 1.207 MPa √m; " SELES, false},
                 {"cohesive_strength", 59.76e6, SELES, false}},
     .remark = "At slow loading; PMMA is stiffer, stronger and less tough at impact."},
    {.name = "steel",
     .title = "structural steel, taken as unbreakable",
     .breakable = false,
     .numbers = {{"density", 7850.0, EUROCODE, false},
                 {"youngs_modulus", 210e9, EUROCODE, false},
                 {"poissons_ratio", 0.3, EUROCODE, false}},
     .remark = "For projectiles and tools. It does not yield either."},
};

int32_t shv_library_count(void)
{
    return (int32_t)(sizeof materials / sizeof materials[0]);
}

const ShvLibraryMaterial *shv_library_get(int32_t index)
{
    return index >= 0 && index < shv_library_count() ? &materials[index] : NULL;
}

const ShvLibraryMaterial *shv_library_find(const char *name)
{
    for (int32_t i = 0; i < shv_library_count(); i++)
        if (strcmp(materials[i].name, name) == 0) return &materials[i];
    return NULL;
}

ShvMaterialDefinition shv_library_definition(const ShvLibraryMaterial *material)
{
    ShvMaterialDefinition definition = shv_material_default();
    const struct {
        const char *key;
        double *value;
    } targets[] = {{"density", &definition.density},
                   {"youngs_modulus", &definition.youngs_modulus},
                   {"poissons_ratio", &definition.poissons_ratio},
                   {"fracture_energy", &definition.fracture_energy},
                   {"cohesive_strength", &definition.cohesive_strength},
                   {"fracture_energy_shear", &definition.fracture_energy_shear},
                   {"cohesive_strength_shear", &definition.cohesive_strength_shear}};
    definition.name = material->name;
    definition.breakable = material->breakable;
    for (const ShvLibraryNumber *number = material->numbers; number->key; number++)
        for (size_t i = 0; i < sizeof targets / sizeof targets[0]; i++)
            if (strcmp(targets[i].key, number->key) == 0) *targets[i].value = number->value;
    return definition;
}
