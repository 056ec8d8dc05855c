// The report: reads what the program has put into the page and draws it.
import 'uplot/dist/uPlot.min.css';
import './report.css';
import { charts } from './chart.js';
import { h } from './dom.js';
import { setPlots } from './plots.js';
import { page, runPage, severalPage } from './run_page.js';
import { sweepPage } from './sweep_page.js';
import { themeSwitch } from './theme.js';

const data = JSON.parse(document.getElementById('data').textContent);

page.title = data.title;
page.card = data.card;
page.opened = data.opened;
setPlots(data.plots);

const kSections = data.sweep ? [['results', 'Sweep'], ['plots', 'Point'], ['settings', 'Table']]
  : [['results', 'Results'], ['bodies', 'Bodies'], ['plots', 'Plots'], ['settings', 'Settings']];

function bar() {
  return h('header', { class: 'top' }, h('a', { class: 'skip', href: '#results' }, 'Skip to the results'),
    h('span', { class: 'brand' }, h('i', { 'aria-hidden': 'true' }), 'hardbody'),
    h('nav', { 'aria-label': 'Sections' }, kSections.map(([id, name]) => h('a', { href: `#${id}` }, name))), themeSwitch());
}

function content() {
  if (data.sweep) return sweepPage(data.sweep);
  return data.runs.length === 1 ? runPage(data.runs[0]) : severalPage(data.runs, data.title);
}

document.getElementById('report').replaceChildren(bar(), h('main', {}, content().flat(2).filter(Boolean)),
  h('footer', { class: 'bottom' }, `Written by hardbody ${data.program}. This file holds all of its data and asks no network for anything.`));

/** Content of the page, for tests and for the console. */
window.hardbodyReport = {
  get charts() { return charts.map((chart) => ({ id: chart.plot.id, points: chart.points, series: chart.plot.series.map((s) => s.label),
    colours: chart.plot.series.map((s) => s.colour), range: chart.u ? [chart.u.scales.y.min, chart.u.scales.y.max] : null,
    yLabel: chart.plot.y.label, about: chart.plot.about })); },
  get views() { return page.views.map((view) => ({ bodies: view.bodies, frame: view.frame, frames: view.data.frames.length, drawn: view.drawn ?? 0, triangles: view.renderer?.info.render.triangles ?? 0, calls: view.renderer?.info.render.calls ?? 0 })); },
  get map() { const { sweep } = page; return sweep ? { points: sweep.sweep.points.length, known: sweep.map.known, segments: sweep.map.segments, shown: sweep.shown } : null; },
  page,
};
