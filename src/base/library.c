/* The one list of the program's materials. A number is a measured one of the source it names; where it follows from other
   numbers the source says how. Addresses, and what else was read, stand in docs/sources.md. */
#include "shiver/library.h"

#include <string.h>

#define FLOAT_GLASS "EN 572 as quoted by VAS Glass, product data of float glass (vasglass.gr)"
#define MUNRO       "R. G. Munro, J. Am. Ceram. Soc. 80 (1997) 1919-1928; NIST SRD 150, sintered Al2O3, at 20 °C"
#define MICHALEK    "M. Michálek et al., Ceramics International (2018), abstract"
#define JOHN_SHAH   "beam of John and Shah, as the Abaqus 6.11 Benchmarks Manual has it (1.19.3)"
#define RUIZ        "G. Ruiz, A. Pandolfi, M. Ortiz, Int. J. Numer. Meth. Eng. 52 (2001) 97-120"
#define CAST_GYPSUM "part 3 of a study of cast gypsum, abstract (discovery.researcher.life)"
#define VEKINIS     "G. Vekinis, M. F. Ashby, P. W. R. Beaumont, J. Mater. Sci. 28 (1993) 3221"
/* Shear values where nobody measured them, from numbers that somebody did. */
#define TRESCA(strength) "half of the compressive strength fc (Tresca, as there is no friction angle), fc = " strength
/* Where the angle of friction is known, the cohesion of the line of that slope through the compressive strength. */
#define COHESION_AT_ANGLE(strength)                                                                                    \
    "fc/(2 tan (45° + φ/2)), the Mohr-Coulomb line of the friction angle φ through fc = " strength
#define RICHART                                                                                                           \
    "37.4°: a pressure p adds k p to the strength in compression, sin φ = (k − 1)/(k + 1), k = 4.1 of F. E. Richart " \
    "et al., 1928, as others quote it"
#define GOODMAN                                                                                                        \
    "R. E. Goodman, Introduction to Rock Mechanics, triaxial tests of Inada biotite granite at 0.1 to 98 MPa, as "     \
    "'Mechanics of Asphalt', Table 2.6, quotes it (with a cohesion of 55.2 MPa, of a stronger stone)"
#define SLIDES       "G τ/σ, so that a facet slides as far before it fails as it opens: assumption"
#define LOURENCO     "P. B. Lourenço, recommendations for masonry (University of Minho): ductility index G/σ of 0.029 mm"
#define PETROVIC     "J. J. Petrovic, J. Mater. Sci. 38 (2003) 1-6, abstract"
#define GAMMON       "P. H. Gammon et al., J. Glaciology 29 (1983) 433-460, at −16 °C"
#define DENT_CLINICS "Dent. Clin. North Am. 61 (2017) 797-819, Table 1"
#define DENTAL       DENT_CLINICS ", and Dent. Mater. 24 (2008) 1477-1485, Table 1"
#define PORCELAIN    "biologyinsights.com on engineering porcelain: 43 to 160 MPa in bending, 590 MPa in compression"
#define VERMELTFOORT "A. T. Vermeltfoort, properties of some clay bricks under varying loading conditions, abstract"
#define GOOCH        "L. Gooch et al., Constr. Build. Mater. 386 (2023) 131578, abstract"
#define NOOR         "S. Noor-E-Khuda, F. Albermani, Constr. Build. Mater. 219 (2019) 111-120, abstract"
#define MODEL_CODE   "CEB-FIP Model Code 1990, as the DIANA manual quotes it (section 18.2.9)"
#define MC_ENERGY    "CEB-FIP Model Code 1990, 30 J/m² (fcm/10 MPa)^0.7 for grains up to 16 mm, as others quote it"
#define EC_DENSITY   "EN 1991-1-1, as structville.com quotes it"
#define EC_POISSON   "EN 1992-1-1, 3.1.3 (4), without cracks, as a spreadsheet quotes it (gist.github.com/jsb2505)"
#define ROCK_JOURNAL "Int. J. Rock Mech. Min. Sci. 2008, abstract (daneshyari.com/en/article/810209)"
#define EC_SCATTER                                                                                                     \
    "Eurocode 2, table 3.1, as buildinghow.com quotes it: the 5 % fractile of the tensile strength is 0.7 of the "     \
    "mean, which m follows from"
#define GRANITE "MakeItFrom.com, granite"
#define ROCKS   "jipmagazine.nl on rocks: granite 7 to 25 MPa in tension, 100 to 250 MPa in compression"
#define SELES   "K. Seles et al., Procedia Structural Integrity 42 (2022) 1721-1727, Table 1"
#define NORTON                                                                                                         \
    "M. P. Norton, D. G. Karczub, Fundamentals of Noise and Vibration Analysis for Engineers, Table 6.1, as "          \
    "github.com/jmrplens/phonometry copies it"
#define HOPKINS  "C. Hopkins, Sound Insulation (2007), Table A2, as github.com/jmrplens/phonometry copies it"
#define VIGRAN   "T. E. Vigran, Building Acoustics (2008), Table 3.1, as github.com/jmrplens/phonometry copies it"
#define QUALIA   "measured by qualia.webs.com (damping factors)"
#define EUROCODE "EN 1993-1-1, 3.2.6, as quoted by eurocodeapplied.com"

static const ShvLibraryMaterial materials[] = {
    {.name = "soda_lime_glass",
     .title = "soda-lime glass, annealed float",
     .breakable = true,
     .unresolved = SHV_UNRESOLVED_TIP_STRENGTH,
     .numbers =
         {{"density", 2500.0, FLOAT_GLASS, false},
          {"youngs_modulus", 70e9, FLOAT_GLASS, false},
          {"poissons_ratio", 0.2, FLOAT_GLASS, false},
          {"loss_factor", 0.001, NORTON "; 0.0006 to 0.002 in Vigran, 2008", false},
          {"fracture_energy", 8.0,
           "twice the surface energy of 3.91 ± 0.12 J/m² of S. M. Wiederhorn, J. Am. Ceram. Soc. 52 (1969) 99-105, as "
           "tabulated by S. Reich et al., Procedia Structural Integrity 13 (2018) 28-33, rounded",
           false},
          {"cohesive_strength", 40e6,
           "tensile strength 41 MPa of annealed soda-lime glass, MakeItFrom.com, rounded; EN 572 has 45 MPa in bending",
           false},
          {"cohesive_strength_shear", 400e6,
           "assumption: ten times that in tension, as the strength in compression (about 1 GPa) suggests", false},
          {"weibull_modulus", 7.0,
           "ASTM E1300-09a, parameter m of flaws in the surface of windows, as github.com/JacquesCarette/Drasil "
           "(GlassBR) "
           "quotes it",
           false},
          {"weibull_area", 0.2134,
           "1/(k σ⁷), of which 63 % break under σ, with the flaw parameter k = 2.86e-53 m¹²/N⁷ of the same source",
           false}},
     .remark = "The strength is that of panes with the scratches of use; fresh fibres bear a hundred times that."},
    {.name = "tempered_glass",
     .title = "soda-lime glass, thermally tempered",
     .breakable = true,
     .unresolved = SHV_UNRESOLVED_TIP_STRENGTH,
     .numbers = {{"density", 2500.0, FLOAT_GLASS, false},
                 {"youngs_modulus", 70e9, FLOAT_GLASS, false},
                 {"poissons_ratio", 0.2, FLOAT_GLASS, false},
                 {"loss_factor", 0.001, "as soda_lime_glass", false},
                 {"fracture_energy", 8.0, "as soda_lime_glass", false},
                 {"cohesive_strength", 120e6, "in bending, tempered; " FLOAT_GLASS, false},
                 {"fracture_energy_shear", 33.3, SLIDES, false},
                 {"cohesive_strength_shear", 500e6, TRESCA("1000 MPa; ") FLOAT_GLASS, false},
                 {"weibull_modulus", 20.0,
                  "assumption: the compression of its surface, which scatters little, is most of its strength", false}},
     .remark = "The strength holds the compression of its surface. What is stored within, and lets a real pane crumble "
               "into dice, is not modelled."},
    {.name = "alumina",
     .title = "alumina, sintered, 99.5 % and more",
     .breakable = true,
     .unresolved = SHV_UNRESOLVED_TIP_STRENGTH,
     .numbers = {{"density", 3984.0, MUNRO, false},
                 {"youngs_modulus", 416e9, MUNRO, false},
                 {"poissons_ratio", 0.23, "1/2 − E/(6 K) with K = 257 GPa; " MUNRO, false},
                 {"fracture_energy", 27.9,
                  "K²(1−ν²)/E with a toughness K of 3.5 MPa √m, NIST SRD 150, a row that was not read; 3.1 in dense "
                  "alumina: " DENT_CLINICS,
                  true},
                 {"cohesive_strength", 380e6, "strength in bending; " MUNRO, false},
                 {"fracture_energy_shear", 110.0, SLIDES, false},
                 {"cohesive_strength_shear", 1.5e9, TRESCA("3000 MPa; ") MUNRO, false},
                 {"weibull_modulus", 11.0, "near the 11.8 of small discs of pure alumina; " MICHALEK, false}},
     .remark = "Grains of 5 µm."},
    {.name = "concrete",
     .title = "concrete (fine mortar of impact tests)",
     .breakable = true,
     .numbers = {{"density", 2400.0, JOHN_SHAH, false},
                 {"youngs_modulus", 31.37e9, JOHN_SHAH, false},
                 {"poissons_ratio", 0.2, JOHN_SHAH, false},
                 {"loss_factor", 0.006, "0.004 to 0.008 of concrete, " VIGRAN, false},
                 {"fracture_energy", 31.1, RUIZ "; the Abaqus manual has 19.6 J/m² for the same beam", true},
                 {"cohesive_strength", 10.45e6, JOHN_SHAH, false},
                 {"fracture_energy_shear", 156.0, SLIDES, false},
                 {"cohesive_strength_shear", 52.25e6, TRESCA("10 σ, assumption: as a rule of concrete"), false},
                 {"weibull_modulus", 6.6, EC_SCATTER, false}},
     .remark = "The strength is high; common concrete bears a few MPa and has a longer zone."},
    {.name = "plaster",
     .title = "gypsum plaster, dry",
     .breakable = true,
     .unresolved = SHV_UNRESOLVED_TIP_STRENGTH,
     .numbers = {{"density", 1200.0, "cast with 0.6 of water; lerncoach.li, strength of plaster", false},
                 {"youngs_modulus", 5e9,
                  "handbook value; about 10 GPa in cast gypsum of more than 30 MPa in compression: " CAST_GYPSUM, true},
                 {"poissons_ratio", 0.2, "handbook value", true},
                 {"loss_factor", 0.005, NORTON, false},
                 {"fracture_energy", 10.0, "handbook value; it goes with porosity: " VEKINIS, true},
                 {"cohesive_strength", 2.5e6, "of 1 to 3 MPa, 3 to 10 % of 30 MPa in compression; " CAST_GYPSUM, false},
                 {"fracture_energy_shear", 50.0, "assumption: five times that in tension", false},
                 {"cohesive_strength_shear", 12.5e6,
                  "assumption: five times that in tension, as the strength in compression suggests", false},
                 {"weibull_modulus", 10.0, "assumption: as of other porous ceramics", false}},
     .remark = "It varies by factors with the water it was mixed with."},
    {.name = "pmma",
     .title = "PMMA (acrylic glass)",
     .breakable = true,
     .unresolved = SHV_UNRESOLVED_TIP_STRENGTH,
     .numbers =
         {{"density", 1200.0, "MakeItFrom.com, PMMA", false},
          {"youngs_modulus", 3.2043e9, SELES, false},
          {"poissons_ratio", 0.374, SELES, false},
          {"loss_factor", 0.07, "perspex, " QUALIA, false},
          {"fracture_energy", 391.0, "K²(1−ν²)/E with a toughness K of 1.207 MPa √m; " SELES, false},
          {"cohesive_strength", 59.76e6, SELES, false},
          {"fracture_energy_shear", 347.0, SLIDES, false},
          {"cohesive_strength_shear", 53e6,
           "55/62 σ: UFGS, acrylic glazing, Table 3-1: at least 55 MPa in shear (ASTM D732) and 62 MPa in tension "
           "(ASTM D638)",
           false},
          {"weibull_modulus", 20.0, "assumption: it scatters little", false}},
     .remark = "At slow loading; PMMA is stiffer, stronger and less tough at impact."},
    {.name = "porcelain",
     .title = "porcelain, hard, of tableware",
     .breakable = true,
     .unresolved = SHV_UNRESOLVED_TIP_STRENGTH,
     .numbers = {{"density", 2400.0, "material-properties.org, porcelain", false},
                 {"youngs_modulus", 70e9, "of 65 to 80 GPa in feldspathic porcelain of teeth; " DENTAL, false},
                 {"poissons_ratio", 0.2, "handbook value", true},
                 {"fracture_energy", 23.2,
                  "K²(1−ν²)/E with a toughness K of 1.3 MPa √m, above the 1.0 to 1.26 of feldspathic porcelain of "
                  "teeth; " DENTAL,
                  false},
                 {"cohesive_strength", 60e6, PORCELAIN, false},
                 {"fracture_energy_shear", 114.0, SLIDES, false},
                 {"cohesive_strength_shear", 295e6, TRESCA("590 MPa; ") PORCELAIN, false},
                 {"weibull_modulus", 10.0, "Weibull moduli of 3 to 14 of fired clay, Cerâmica 65 (2019) 240, abstract",
                  false}},
     .remark = "At the lower end of technical porcelain: glazed ware with the scratches of use."},
    {.name = "stoneware",
     .title = "stoneware, pottery",
     .breakable = true,
     .unresolved = SHV_UNRESOLVED_TIP_STRENGTH,
     .numbers =
         {{"density", 2200.0, "handbook value", true},
          {"youngs_modulus", 45e9, "handbook value", true},
          {"poissons_ratio", 0.2, "handbook value", true},
          {"loss_factor", 0.012, "fired clay, " QUALIA "; brick has 0.01 in Hopkins", false},
          {"fracture_energy", 21.3, "K²(1−ν²)/E with a toughness K of 1.0 MPa √m, handbook value", true},
          {"cohesive_strength", 35e6,
           "bending strength required of stoneware tiles with little porosity, EN 14411 group BIa, as a maker's "
           "data sheet (Refin) quotes it",
           false},
          {"fracture_energy_shear", 91.3, SLIDES, false},
          {"cohesive_strength_shear", 150e6, TRESCA("300 MPa, handbook value"), true},
          {"weibull_modulus", 10.0, "Weibull moduli of 3 to 14 of fired clay, Cerâmica 65 (2019) 240, abstract", false},
          {"weibull_volume", 3.3e-6,
           "assumption: V/(2(m+1)²), what counts of a tile of 300 x 300 x 9 mm that is bent by three lines", true}},
     .remark = "Mugs, vases, bowls, floor tiles. It varies with clay and firing by a factor of two."},
    {.name = "brick",
     .title = "clay brick, solid",
     .breakable = true,
     .numbers = {{"density", 1800.0,
                  "18 kN/m³, masonry of solid clay bricks: Spanish building code (CTE), Table C.1, as "
                  "github.com/xcfem/xc quotes it",
                  false},
                 {"youngs_modulus", 12e9, "400 times the compressive strength, here 30 MPa; " VERMELTFOORT, false},
                 {"poissons_ratio", 0.15, "handbook value", true},
                 {"loss_factor", 0.01, HOPKINS ", where it is an estimate; 0.015 in Norton and Karczub", false},
                 {"fracture_energy", 67.5, LOURENCO, true},
                 {"cohesive_strength", 2.33e6,
                  "strength in bending a tenth of 30 MPa (" NOOR "), that in tension less by 1.29 (" GOOCH ")", false},
                 {"fracture_energy_shear", 435.0, SLIDES, false},
                 {"cohesive_strength_shear", 15e6, TRESCA("30 MPa, as above"), false},
                 {"weibull_modulus", 5.0, "coefficient of variation of about 25 % in tension; " VERMELTFOORT, false}},
     .remark = "A brick of middling strength."},
    {.name = "concrete_c30",
     .title = "concrete C30",
     .breakable = true,
     .numbers = {{"density", 2400.0, "24 kN/m³, concrete of normal weight; " EC_DENSITY, false},
                 {"youngs_modulus", 33.55e9, "21.5 GPa (fcm/10 MPa)^(1/3), fcm = 38 MPa; " MODEL_CODE, false},
                 {"poissons_ratio", 0.2, EC_POISSON, false},
                 {"loss_factor", 0.006, "0.004 to 0.008, " VIGRAN, false},
                 {"fracture_energy", 76.4, MC_ENERGY, false},
                 {"cohesive_strength", 2.91e6, "1.4 MPa (fck/10 MPa)^(2/3); " MODEL_CODE, false},
                 {"fracture_energy_shear", 249.4, SLIDES, false},
                 {"cohesive_strength_shear", 9.5e6,
                  COHESION_AT_ANGLE("38 MPa, the mean of Eurocode 2, table 3.1, as buildinghow.com quotes it"), false},
                 {"friction_angle", 37.0, RICHART, false},
                 {"weibull_modulus", 6.6, EC_SCATTER, false}},
     .remark = "Common structural concrete."},
    {.name = "concrete_c50",
     .title = "concrete C50",
     .breakable = true,
     .numbers = {{"density", 2400.0, "24 kN/m³, concrete of normal weight; " EC_DENSITY, false},
                 {"youngs_modulus", 38.6e9, "21.5 GPa (fcm/10 MPa)^(1/3), fcm = 58 MPa; " MODEL_CODE, false},
                 {"poissons_ratio", 0.2, EC_POISSON, false},
                 {"loss_factor", 0.006, "0.004 to 0.008, " VIGRAN, false},
                 {"fracture_energy", 102.7, MC_ENERGY, false},
                 {"cohesive_strength", 4.09e6, "1.4 MPa (fck/10 MPa)^(2/3); " MODEL_CODE, false},
                 {"fracture_energy_shear", 364.1, SLIDES, false},
                 {"cohesive_strength_shear", 14.5e6,
                  COHESION_AT_ANGLE("58 MPa, the mean of Eurocode 2, table 3.1, as buildinghow.com quotes it"), false},
                 {"friction_angle", 37.0, RICHART, false},
                 {"weibull_modulus", 6.6, EC_SCATTER, false}},
     .remark = "High-strength structural concrete."},
    {.name = "mortar",
     .title = "cement-lime mortar, M10",
     .breakable = true,
     .numbers = {{"density", 1900.0, "of 18 to 20 kN/m³, lime-cement mortar; " EC_DENSITY, false},
                 {"youngs_modulus", 10e9, "1000 times the compressive strength of 10 MPa, rule of thumb", true},
                 {"poissons_ratio", 0.2, "handbook value", true},
                 {"loss_factor", 0.013, HOPKINS, false},
                 {"fracture_energy", 43.5, LOURENCO, true},
                 {"cohesive_strength", 1.5e6, "half of a strength in bending of 3 MPa, handbook value", true},
                 {"fracture_energy_shear", 145.0, SLIDES, false},
                 {"cohesive_strength_shear", 5e6, TRESCA("10 MPa, its class"), false},
                 {"weibull_modulus", 5.0, "assumption: as brick", false}},
     .remark = "Of joints and renders. The mortar of impact tests, much stronger, is `concrete`."},
    {.name = "granite",
     .title = "granite",
     .breakable = true,
     .unresolved = SHV_UNRESOLVED_TIP_STRENGTH,
     .numbers =
         {{"density", 2650.0, "of 2650 to 2750; splitenz.ca, density of granite", false},
          {"youngs_modulus", 70e9, GRANITE, false},
          {"poissons_ratio", 0.25, GRANITE, false},
          {"fracture_energy", 38.7,
           "K²(1−ν²)/E with a toughness K of 1.7 MPa √m, of 0.71 to 1.89 in four granites of fine grain; " ROCK_JOURNAL,
           false},
          {"cohesive_strength", 10e6, ROCKS, false},
          {"fracture_energy_shear", 127.0, SLIDES, false},
          {"cohesive_strength_shear", 32.9e6, COHESION_AT_ANGLE("170 MPa; ") ROCKS, false},
          {"friction_angle", 47.7, GOODMAN, false},
          {"weibull_modulus", 15.0,
           "of 8 to 25 for granite in tension, as notes on a model of thermal spalling quote them", false}},
     .remark = "Sound and fine-grained; weathered granite bears a third."},
    {.name = "ice",
     .title = "water ice, polycrystalline",
     .breakable = true,
     .unresolved = SHV_UNRESOLVED_TIP_STRENGTH,
     .numbers = {{"density", 917.0, "at 0 °C; newton.dep.anl.gov, density of ice", false},
                 {"youngs_modulus", 9.33e9,
                  GAMMON "; the constants of the crystal in its abstract make it 9.1 (Reuss) to 9.3 GPa (Voigt)",
                  false},
                 {"poissons_ratio", 0.325, GAMMON "; likewise 0.326 (Voigt) to 0.330 (Reuss)", false},
                 {"fracture_energy", 0.96, "K²(1−ν²)/E with a toughness K of 100 kPa √m, of 50 to 150; " PETROVIC,
                  false},
                 {"cohesive_strength", 1.5e6, "of 0.7 to 3.1 MPa; " PETROVIC, false},
                 {"fracture_energy_shear", 3.2, SLIDES, false},
                 {"cohesive_strength_shear", 5e6, TRESCA("10 MPa, of 5 to 25; ") PETROVIC, false},
                 {"weibull_modulus", 5.0, PETROVIC, false}},
     .remark = "Under impact, where it does not creep."},
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
                   {"loss_factor", &definition.loss_factor},
                   {"fracture_energy", &definition.fracture_energy},
                   {"cohesive_strength", &definition.cohesive_strength},
                   {"fracture_energy_shear", &definition.fracture_energy_shear},
                   {"cohesive_strength_shear", &definition.cohesive_strength_shear},
                   {"friction_angle", &definition.friction_angle_degrees},
                   {"weibull_modulus", &definition.weibull_modulus},
                   {"weibull_volume", &definition.weibull_volume},
                   {"weibull_area", &definition.weibull_area}};
    definition.name = material->name;
    definition.breakable = material->breakable;
    definition.unresolved = material->unresolved;
    for (const ShvLibraryNumber *number = material->numbers; number->key; number++)
        for (size_t i = 0; i < sizeof targets / sizeof targets[0]; i++)
            if (strcmp(targets[i].key, number->key) == 0) *targets[i].value = number->value;
    return definition;
}
