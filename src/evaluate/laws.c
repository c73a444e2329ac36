#include "evaluate/laws.h"

#include <math.h>

/* Position and velocity after `time` of constant acceleration. */
static ShvLineMotion accelerate(ShvLineMotion from, double acceleration, double time)
{
    return (ShvLineMotion){from.position + (from.velocity + 0.5 * acceleration * time) * time,
                           from.velocity + acceleration * time};
}

ShvLineMotion shv_law_bounce(double height, double velocity, double gravity, double restitution, double time)
{
    ShvLineMotion motion = {height, velocity};
    /* v_end² = v² + 2 g h; the first root of h + v t − ½ g t² after the start is (v + |v_end|)/g. */
    double speed = sqrt(velocity * velocity + 2.0 * gravity * height);
    double fall = (velocity + speed) / gravity;
    while (time >= fall) {
        time -= fall;
        speed *= restitution;
        motion = (ShvLineMotion){0.0, speed};
        fall = 2.0 * speed / gravity;
        /* So short a hop, of less than a thousand steps of double precision, stands for all that follow. */
        if (fall <= 1e-13 * (1.0 + time)) return (ShvLineMotion){0.0, 0.0};
    }
    return accelerate(motion, -gravity, time);
}

/* Friction of acceleration `drag` against the motion of the contact point slows the centre and spins the rim. */
static ShvRollMotion roll_on(ShvRollMotion from, double pull, double drag, double shape, double time)
{
    return (ShvRollMotion){accelerate(from.centre, pull - drag, time), accelerate(from.rim, drag / shape, time)};
}

ShvRollMotion shv_law_roll(double velocity, double rim_speed, double pull, double friction, double shape, double time)
{
    ShvRollMotion motion = {{0.0, velocity}, {0.0, rim_speed}};
    const double slip = velocity - rim_speed;
    if (slip != 0.0) {
        const double drag = copysign(friction, slip), change = pull - drag * (1.0 + 1.0 / shape);
        const double stop = slip * change < 0.0 ? -slip / change : HUGE_VAL;
        motion = roll_on(motion, pull, drag, shape, fmin(time, stop));
        if (time < stop) return motion;
        time -= stop;
        motion.rim.velocity = motion.centre.velocity;
    }
    /* Rolling needs drag = pull shape/(1 + shape). */
    const double needed = isinf(shape) ? pull : pull * shape / (1.0 + shape);
    return roll_on(motion, pull, fabs(needed) <= friction ? needed : copysign(friction, pull), shape, time);
}

ShvLineMotion shv_law_slide(double velocity, double pull, double friction, double time)
{
    return shv_law_roll(velocity, 0.0, pull, friction, HUGE_VAL, time).centre;
}
