/* The one list of keys. It drives reading, the messages about faults, overrides and docs/scene.md. */
#ifndef SHV_SCENE_SCHEMA_H
#define SHV_SCENE_SCHEMA_H

#include <stdbool.h>
#include <stddef.h>

#include "scene/quantity.h"
#include "scene/tree.h"

typedef enum ShvKeyType {
    SHV_KEY_NUMBER, /* double, with or without unit */
    SHV_KEY_INT32,
    SHV_KEY_INT64,
    SHV_KEY_UINT64,
    SHV_KEY_BOOLEAN, /* bool */
    SHV_KEY_TEXT,    /* const char * */
    SHV_KEY_CHOICE,  /* an enum: int */
    SHV_KEY_VECTOR,  /* double[3] */
    SHV_KEY_AXES,    /* bool[3] from a list of x, y, z */
    SHV_KEY_MAPPING, /* keys of `table`, from this offset on */
    SHV_KEY_NAMED,   /* ShvItems: a mapping of names to items of `table` */
    SHV_KEY_LIST,    /* ShvItems: a list of items of `table` */
    SHV_KEY_NODE     /* const ShvNode *, for a reader of its own */
} ShvKeyType;

enum ShvKeyFlag {
    SHV_KEY_REQUIRED = 1,
    SHV_KEY_AUTOMATIC = 2, /* the word auto stands for the default */
    SHV_KEY_INFINITE = 4,  /* .inf is a value */
    SHV_KEY_VARIANT = 8,   /* one of several keys that exclude each other; sets the table's variant */
    SHV_KEY_FILE = 16,     /* names a file that must exist */
    SHV_KEY_DIRECTION = 32 /* a vector that must not be zero */
};

/* low ≤ value ≤ high, open ends excluded. */
typedef struct ShvRange {
    double low, high;
    bool low_open, high_open;
} ShvRange;

/* Ends with a NULL name. */
typedef struct ShvChoice {
    const char *name;
    int value;
} ShvChoice;

typedef struct ShvTable ShvTable;
typedef struct ShvKey {
    const char *name;
    ShvKeyType type;
    ShvDimension dimension;
    unsigned flags;
    const ShvRange *range; /* NULL: any finite number */
    const ShvChoice *choices;
    const ShvTable *table;
    int variant; /* the value of the table's variant enum that this key stands for */
    size_t offset;
    const char *absent; /* what absence means, where the default value does not say it */
    const char *sentence;
} ShvKey;

struct ShvTable {
    const char *name; /* path of such a mapping: "materials.<name>" */
    const char *sentence;
    const ShvKey *keys;
    int key_count;             /* at most 64 */
    size_t size;               /* of an item; 0: part of the struct of the table above */
    void (*start)(void *item); /* fills an item with defaults; NULL: zeros */
    bool variants;             /* exactly one of the keys marked as variants must be there */
    size_t variant_offset;
};

typedef struct ShvItems {
    void *data;
    int32_t count;
} ShvItems;

/* What every item begins with. */
typedef struct ShvItemHead {
    const char *name;   /* NULL in a list */
    const ShvNode *key; /* of the name; in a list the item itself */
    const ShvNode *node;
    bool good; /* read without errors */
} ShvItemHead;

typedef struct ShvMaterialItem {
    ShvItemHead head;
    ShvMaterialDefinition definition;
    const char *library; /* NULL: none; its numbers are in the tree already */
} ShvMaterialItem;

typedef struct ShvCornerItem {
    ShvItemHead head;
    double radius, height;
} ShvCornerItem;

typedef struct ShvCrackItem {
    ShvItemHead head;
    ShvCrackDefinition definition;
} ShvCrackItem;

typedef struct ShvGroupItem {
    ShvItemHead head;
    ShvGroupDefinition definition;
} ShvGroupItem;

typedef struct ShvObjectItem {
    ShvItemHead head;
    ShvObjectDefinition definition;
    ShvItems groups;
    int32_t repeat_count; /* 0: stands for itself */
    double repeat_offset[3];
    double repeat_spread[3]; /* m: each is shifted at random by up to half of it */
    bool repeat_turn;        /* each is turned at random */
    uint64_t repeat_seed;
    ShvItems profile; /* of a turned mesh */
    ShvItems cracks;
    int plane_strain; /* axis along which none of its nodes moves: 1 + index; 0: none */
} ShvObjectItem;

typedef struct ShvConditionItem {
    ShvItemHead head;
    ShvConditionDefinition definition;
} ShvConditionItem;

typedef struct ShvKeyframeItem {
    ShvItemHead head;
    ShvKeyframe keyframe;
} ShvKeyframeItem;

typedef struct ShvObstacleItem {
    ShvItemHead head;
    ShvObstacleDefinition definition;
    ShvItems keyframes;
} ShvObstacleItem;

typedef struct ShvProbeItem {
    ShvItemHead head;
    ShvProbeDefinition definition;
} ShvProbeItem;

typedef struct ShvEventItem {
    ShvItemHead head;
    ShvEventDefinition definition;
} ShvEventItem;

typedef struct ShvSceneItem {
    ShvItemHead head;
    ShvSceneDefinition definition;
    int32_t version;
    ShvItems materials, objects, supports, velocities, tractions, obstacles, events, probes;
} ShvSceneItem;

/* The top level; its size is that of ShvSceneItem. */
extern const ShvTable shv_scene_table;

/* Fills an item of a table with its defaults. */
void shv_table_start(const ShvTable *table, void *item);
const ShvKey *shv_table_find(const ShvTable *table, const char *name);
/* "unknown key 'word' in …", with the nearest key or all of them; `item` as of shv_table_label. */
void shv_table_report_unknown(const ShvTable *table, const char *item, ShvDiagnostics *diagnostics, ShvPlace place,
                              const char *word);
typedef struct ShvLabel {
    char text[160];
} ShvLabel;
/* The table's path with the item's name in it: "objects.plate.mesh". `item` NULL: "objects.<name>.mesh". */
ShvLabel shv_table_label(const ShvTable *table, const char *item);
/* The name of a choice's value. */
const char *shv_choice_name(const ShvChoice *choices, int value);
/* "greater than 0 and at most 1"; "" of any finite number. */
void shv_range_describe(const ShvRange *range, char *buffer, size_t size);
bool shv_range_holds(const ShvRange *range, double value);
/* What a key takes: "a stress in Pa (or kPa, MPa, GPa, N/mm2), greater than 0". */
void shv_key_describe(const ShvKey *key, char *buffer, size_t size);
/* All key names, or those of variants alone: "box, ball or hollow_ball". */
void shv_table_list(const ShvTable *table, bool variants_alone, char *buffer, size_t size);

/* Letters, digits, '_' and '-', at most 63 of them: names appear in files, paths and overrides. */
bool shv_is_name(const char *text);

#endif
