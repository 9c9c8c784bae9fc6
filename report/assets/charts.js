// Draws the figures of a page when they come into view, zooms their time axes together, and shows on them the
// time that the view plays.
(() => {
  "use strict";
  const config = { responsive: true, displaylogo: false, modeBarButtonsToRemove: ["lasso2d", "select2d"] };
  const style = {
    font: { family: 'system-ui, "DejaVu Sans", sans-serif', size: 12, color: "#1b1b1b" },
    paper_bgcolor: "#fff", plot_bgcolor: "#fff",
    legend: { orientation: "v", x: 1.02, y: 1, xanchor: "left", groupclick: "togglegroup" },
  };
  const axis = { showline: true, linecolor: "#777", gridcolor: "#eceef0", zeroline: false, ticks: "outside", mirror: true };
  const charts = [];
  // The stretch of time that all charts of a group show; none: all of it.
  const ranges = new Map();
  let time_s = null;
  let is_linking = false;

  function chartOf(figure) {
    const spec = JSON.parse(figure.querySelector("script").textContent);
    for (const key of Object.keys(spec.layout)) {
      if (/^[xy]axis/.test(key)) spec.layout[key] = { ...axis, ...spec.layout[key] };
    }
    Object.assign(spec.layout, style);
    const group = figure.closest("[data-zoom=section] > section");
    const chart = { figure, group, plot: figure.querySelector(".plot"), spec, drawn: false, is_seen: false, cursors: [] };
    figure.chart = chart;
    return chart;
  }

  function draw(chart) {
    if (chart.drawn) return;
    chart.drawn = true;
    const range = ranges.get(chart.group);
    if (range) chart.spec.time_axes.forEach((name) => { chart.spec.layout[name].range = [...range]; });
    chart.ready = Plotly.newPlot(chart.plot, chart.spec.data, chart.spec.layout, config).then(() => {
      chart.plot.style.minHeight = "";
      if (chart.spec.time_axes.length === 0) return;
      chart.plot.on("plotly_relayout", (change) => link(chart, change));
      chart.plot.on("plotly_click", (event) => seek(event.points[0]));
      chart.plot.on("plotly_afterplot", () => placeCursors(chart));
      chart.cursors = chart.spec.time_axes.map(() => {
        const cursor = document.createElement("div");
        cursor.className = "time-cursor";
        chart.plot.appendChild(cursor);
        return cursor;
      });
      placeCursors(chart);
    });
  }

  // What one time axis shows, all of its group show.
  function link(source, change) {
    if (is_linking) return;
    const range = changedRange(source, change);
    if (range === undefined) return;
    ranges.set(source.group, range);
    is_linking = true;
    const others = charts.filter((chart) => (
      chart !== source && chart.group === source.group && chart.drawn && chart.spec.time_axes.length > 0));
    const done = others.map((chart) => {
      const update = {};
      for (const name of chart.spec.time_axes) {
        if (range) update[name + ".range"] = [...range];
        else update[name + ".autorange"] = true;
      }
      return Plotly.relayout(chart.plot, update);
    });
    Promise.all(done).finally(() => { is_linking = false; });
  }

  // The new range of a time axis, null for all of it, undefined if no time axis has changed.
  function changedRange(chart, change) {
    for (const name of chart.spec.time_axes) {
      if (change[name + ".autorange"]) return null;
      if (change[name + ".range"]) return change[name + ".range"];
      if (change[name + ".range[0]"] !== undefined) return [change[name + ".range[0]"], change[name + ".range[1]"]];
    }
    return undefined;
  }

  function seek(point) {
    document.dispatchEvent(new CustomEvent("aerobot:seek", { detail: { time_s: Number(point.x) } }));
  }

  function placeCursors(chart) {
    const layout = chart.plot._fullLayout;
    chart.cursors.forEach((cursor, index) => {
      const x = layout && layout[chart.spec.time_axes[index]];
      const y = x && layout["yaxis" + x.anchor.slice(1)];
      const place = x && time_s !== null ? x.l2p(time_s) : NaN;
      const is_shown = place >= 0 && place <= (x ? x._length : 0);
      cursor.style.display = is_shown ? "block" : "none";
      if (!is_shown) return;
      cursor.style.left = `${x._offset + place}px`;
      cursor.style.top = `${y._offset}px`;
      cursor.style.height = `${y._length}px`;
    });
  }

  // Of charts that nobody sees the cursor is placed when they are scrolled to.
  document.addEventListener("aerobot:time", (event) => {
    time_s = event.detail.time_s;
    charts.forEach((chart) => { if (chart.is_seen && chart.cursors.length) placeCursors(chart); });
  });

  const eyes = new IntersectionObserver((entries) => {
    entries.forEach((entry) => {
      const { chart } = entry.target;
      chart.is_seen = entry.isIntersecting;
      if (chart.is_seen && chart.cursors.length) placeCursors(chart);
    });
  });

  function start() {
    document.querySelectorAll("figure.chart").forEach((figure) => charts.push(chartOf(figure)));
    const watcher = new IntersectionObserver((entries) => {
      entries.filter((entry) => entry.isIntersecting).forEach((entry) => {
        watcher.unobserve(entry.target);
        draw(entry.target.chart);
      });
    }, { rootMargin: "500px" });
    charts.forEach((chart) => { watcher.observe(chart.figure); eyes.observe(chart.figure); });
    window.addEventListener("beforeprint", () => charts.forEach(draw));
    // For scripts that look at a page: everything drawn, and what the time axes of the first group show.
    window.aerobotCharts = {
      drawAll: () => { charts.forEach(draw); return Promise.all(charts.map((chart) => chart.ready)); },
      names: () => charts.map((chart) => chart.figure.dataset.name),
      timeRanges: () => charts.filter((chart) => chart.drawn && chart.spec.time_axes.length)
        .filter((chart, _, timed) => chart.group === timed[0].group)
        .map((chart) => [...chart.plot._fullLayout[chart.spec.time_axes[0]].range]),
    };
  }
  if (document.readyState === "loading") document.addEventListener("DOMContentLoaded", start);
  else start();
})();
