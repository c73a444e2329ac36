// Time of the runs against place on the screen (0 … 1): even in time, or, stretched, even in frames, so that frames that are
// microseconds apart get as long as the others.
export class Clock {
  constructor(runs) {
    this.times = [...new Set(runs.flatMap((run) => [...run.time]))].sort((a, b) => a - b);
    this.stretched = false;
    this.place = 0;
  }
  get first() { return this.times[0]; }
  get last() { return this.times.at(-1); }

  // Number of frame (with a fraction) at a time.
  index(time) {
    const { times } = this;
    let low = 0, high = times.length - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (times[middle] <= time) low = middle; else high = middle - 1;
    }
    const step = low + 1 < times.length ? times[low + 1] - times[low] : 0;
    return low + (step > 0 ? Math.min(1, Math.max(0, (time - times[low]) / step)) : 0);
  }
  placeOf(time) {
    if (this.stretched) return this.index(time) / Math.max(1, this.times.length - 1);
    return this.last > this.first ? (time - this.first) / (this.last - this.first) : 0;
  }
  // That of a frame where it is one but for rounding, or pieces would be those of the frame before.
  timeOf(place) {
    const { times } = this, time = this.unrounded(Math.min(1, Math.max(0, place)));
    const frame = times[Math.round(this.index(time))];
    return Math.abs(time - frame) <= 1e-12 * (this.last - this.first) ? frame : time;
  }
  unrounded(place) {
    if (!this.stretched) return this.first + place * (this.last - this.first);
    const index = place * (this.times.length - 1), i = Math.min(Math.floor(index), Math.max(0, this.times.length - 2));
    return this.times[i] + (index - i) * ((this.times[i + 1] ?? this.times[i]) - this.times[i]);
  }
  get time() { return this.timeOf(this.place); }
  set time(time) { this.place = this.placeOf(time); }
  stretch(on) {
    const { time } = this;
    this.stretched = on;
    this.time = time;
  }
  // To the next or last frame of any run.
  step(by) {
    const index = this.index(this.time);
    const next = by > 0 ? Math.floor(index + 1e-6) + 1 : Math.ceil(index - 1e-6) - 1;
    this.time = this.times[Math.min(this.times.length - 1, Math.max(0, next))];
  }
}
