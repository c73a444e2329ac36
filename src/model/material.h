/* Materials as the solver sees them: definitions checked once, derived constants beside them. */
#ifndef SHV_MODEL_MATERIAL_H
#define SHV_MODEL_MATERIAL_H

#include <math.h>

#include "base/memory.h"
#include "shiver/definition.h"

enum { SHV_NORMAL = 0, SHV_SHEAR = 1 };

typedef struct ShvMaterial {
    const char *name;
    double density, youngs_modulus, poissons_ratio;
    double lambda, mu;         /* Lamé constants, Pa */
    double dilatational_speed; /* √((λ+2µ)/ρ), m/s */
    double bar_speed;          /* √(E/ρ), m/s */
    double shear_speed;        /* √(µ/ρ), m/s */
    ShvKinematics kinematics;
    bool smoothed; /* strain is averaged over the tets round each edge (solid/smoothing.h) */
    bool breakable;
    ShvCohesiveLaw law;
    double fracture_energy[2];               /* normal, shear, J/m²; in effect, see shv_material_resolve */
    double strength[2];                      /* normal, shear, Pa; in effect */
    double nominal_energy, nominal_strength; /* normal, as given */
    ShvUnresolved unresolved;
    double zone_edges; /* mean edges that a resolved zone spans */
    double mesh_edge;  /* m: mean edge of the coarsest object of it; 0 before shv_material_resolve */
    double shape[2];   /* PPR α, β */
    double weibull_modulus, weibull_volume, weibull_area;
    double face_restitution;
    double loss_factor;
    double friction; /* tan φ */
    double riding
        [2]; /* cos and sin of the angle between the least compression and the way in which faces slide (star.h) */
} ShvMaterial;

/* Checks a definition (cookie, ranges; the message names the material and key) and derives the rest. */
ShvStatus shv_material_make(ShvMaterial *material, const ShvMaterialDefinition *definition, ShvError *error);

/* Whether any facet of it can ever open: breakable, and of finite strength. */
static inline bool shv_material_can_open(const ShvMaterial *material)
{
    return material->breakable && isfinite(material->strength[SHV_NORMAL]);
}

/* Fits the material to the mean edge of its mesh: where the cohesive zone R is shorter than zone_edges × edge, and the material
   asks for it, strengths are multiplied by √(R / (zone_edges edge)) or energies by zone_edges edge / R, both of which make
   R = zone_edges × edge. The first is the lowered interface strength of Turon, Dávila, Camanho and Costa (Engineering
   Fracture Mechanics 74, 2007, 1665-1682) with the zone length below; the second keeps the strength instead. */
void shv_material_resolve(ShvMaterial *material, double edge);
/* Longest mean edge at which the material as given is resolved, m: R of the nominal strength and energy over zone_edges. */
double shv_material_resolved_edge(const ShvMaterial *material);
/* How many times G a crack tip costs on a mesh of this edge at least, where it is more than once: the stress K/√(2πr) at
   the middle of the edge ahead of the tip, r = edge/2, has to reach the strength in effect, so that
   K²(1−ν²)/E = π edge σ² (1−ν²)/E = (π²/8) (edge/R) G. An estimate of size, not a prediction. */
double shv_material_tip_toughness(const ShvMaterial *material, double edge);

/* c √(E G/h), Pa: what the facets of a mesh of edges h have to hold ahead of a crack for its growth to cost G; with the strength,
   whichever is less, where SHV_UNRESOLVED_TIP_STRENGTH asks for it. */
double shv_material_tip_strength(const ShvMaterial *material, double edge);

/* Length over which a crack tip softens, R = (π/8) E/(1−ν²) G/σ², m (physics of cohesive zones; 5-10 elements resolve
   it), and the length 2 E G/σ² above which one element in series with a crack snaps back. Infinite when σ = 0 and
   where nothing can open. */
double shv_material_cohesive_zone(const ShvMaterial *material);
double shv_material_snap_back(const ShvMaterial *material);
/* Stress along a free column at which planes in it slide, 2 τ tan(45° + φ/2) (Mohr and Coulomb; the longer planes through a mesh
   of tets bear a little more, docs/cohesive.md), Pa; infinite where nothing can. */
double shv_material_compressive_strength(const ShvMaterial *material);
/* Final normal opening α G/σ (PPR) or 2 G/σ (Camacho-Ortiz), m. */
double shv_material_final_opening(const ShvMaterial *material);

#endif
