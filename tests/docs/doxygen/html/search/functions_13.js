var searchData=
[
  ['take_0',['take',['../classagrisee_1_1study_1_1GreedyCover.html#a9adee00ecdb04bf215b7bd2d3e59645d',1,'agrisee::study::GreedyCover::take()'],['../classagrisee_1_1see_1_1Planner.html#a9157c84d53daca438b50ec0c777584a1',1,'agrisee::see::Planner::take()']]],
  ['text_1',['text',['../classagrisee_1_1io_1_1Fingerprint.html#ab5dfe9011fa6452c814f2b37a9645678',1,'agrisee::io::Fingerprint']]],
  ['thinned_2',['thinned',['../process__stages_8hpp.html#a8311372d2e77e87f285dda3e84b436a2',1,'agrisee']]],
  ['throw_5fif_5fcancelled_3',['throw_if_cancelled',['../cancellation_8hpp.html#ab54601899cdd7dba665f6a1634e750f8',1,'agrisee']]],
  ['times_4',['times',['../structagrisee_1_1Ellipsoid.html#acbb85febc743c5bdee278cae20f866b3',1,'agrisee::Ellipsoid']]],
  ['to_5fstring_5',['to_string',['../icp__parameters_8hpp.html#ac046ca8d004f267f5641c544bb9e034c',1,'agrisee::to_string()'],['../fault__record_8hpp.html#ad3bdf41b55dbadc62f72e8aef542199b',1,'agrisee::study::to_string()'],['../depth__noise_8hpp.html#af3880c75f6602fb84d057453c3cee1b5',1,'agrisee::sensor::to_string()'],['../result_8hpp.html#a8287eaadb4e4044b1788ad18f9952d5f',1,'agrisee::to_string(PickingReason reason)'],['../result_8hpp.html#afc15ecd0a623a749f0869b539e4313d4',1,'agrisee::to_string(StopReason reason)'],['../collision_8hpp.html#ad69fa387ed136968d7738c7dfb728c6c',1,'agrisee::arm::to_string()']]],
  ['tracedscene_6',['TracedScene',['../classagrisee_1_1TracedScene.html#ad20d2283c2940e4f9995fde604314323',1,'agrisee::TracedScene']]],
  ['track_7',['track',['../split_8hpp.html#a4494406fe6b1c6b52252d3162739c844',1,'agrisee']]],
  ['transformed_8',['transformed',['../mesh_8hpp.html#ae901db68e5e1fc7d3c5c0d7f5b2f197a',1,'agrisee']]],
  ['truss_5fworkcell_9',['truss_workcell',['../truss_8hpp.html#a2e2b242bda0b50bd8fd45e8b94afda28',1,'agrisee::study']]],
  ['tube_5fmesh_10',['tube_mesh',['../truss__mesh_8hpp.html#a908f376f43e7040a04199ec01c8284b4',1,'agrisee::study']]]
];
