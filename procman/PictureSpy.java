// lcm-spy shows messages of type camera_t as pictures: a double click on CAMERA or CAMERA_DEBUG opens one.
package fathom_spy;

import fathom_lcm.camera_t;
import java.awt.Color;
import java.awt.Dimension;
import java.awt.Graphics;
import java.awt.Graphics2D;
import java.awt.RenderingHints;
import java.awt.event.ActionEvent;
import java.awt.image.BufferedImage;
import java.io.ByteArrayInputStream;
import java.io.IOException;
import javax.imageio.ImageIO;
import javax.swing.AbstractAction;
import javax.swing.Action;
import javax.swing.JDesktopPane;
import javax.swing.JFrame;
import javax.swing.JPanel;
import javax.swing.Timer;
import lcm.spy.ChannelData;
import lcm.spy.SpyPlugin;

public class PictureSpy implements SpyPlugin {
  private static final int PERIOD_MS = 50;

  public boolean canHandle(long fingerprint) {
    return fingerprint == camera_t.LCM_FINGERPRINT;
  }

  public Action getAction(JDesktopPane desktop, final ChannelData channel) {
    return new AbstractAction("Picture") {
      public void actionPerformed(ActionEvent event) {
        new Window(channel);
      }
    };
  }

  /** Shows the newest message of a channel, as lcm-spy has it, until it is closed. */
  private static class Window extends JPanel {
    private final ChannelData channel;
    private final JFrame frame;
    private Object shown;
    private BufferedImage picture;
    private String fault = "no picture yet";

    Window(ChannelData channel) {
      this.channel = channel;
      setPreferredSize(new Dimension(640, 480));
      setBackground(Color.BLACK);
      frame = new JFrame(channel.name);
      frame.setDefaultCloseOperation(JFrame.DISPOSE_ON_CLOSE);
      frame.add(this);
      look();
      frame.pack();
      frame.setLocationByPlatform(true);
      frame.setVisible(true);
      new Timer(PERIOD_MS, event -> {
        if (frame.isDisplayable()) {
          look();
        } else {
          ((Timer) event.getSource()).stop();
        }
      }).start();
    }

    private void look() {
      if (channel.last == shown || channel.last == null) {
        return;
      }
      shown = channel.last;
      try {
        picture = ImageIO.read(new ByteArrayInputStream((byte[]) field("jpeg")));
        fault = picture == null ? "not a JPEG" : "";
        frame.setTitle(String.format("%s: camera %s, %d x %d, %.3f s", channel.name, field("camera"), field("width"),
            field("height"), 1e-6 * (Long) field("utime")));
      } catch (IOException | ReflectiveOperationException error) {
        picture = null;
        fault = "damaged: " + error.getMessage();
      }
      repaint();
    }

    /** lcm-spy loads types and plugins each with a loader of its own: its camera_t is not ours. */
    private Object field(String name) throws ReflectiveOperationException {
      return shown.getClass().getField(name).get(shown);
    }

    @Override
    protected void paintComponent(Graphics graphics) {
      super.paintComponent(graphics);
      if (picture == null) {
        graphics.setColor(Color.WHITE);
        graphics.drawString(fault, 20, 30);
        return;
      }
      double scale = Math.min((double) getWidth() / picture.getWidth(), (double) getHeight() / picture.getHeight());
      int width = (int) Math.round(scale * picture.getWidth()), height = (int) Math.round(scale * picture.getHeight());
      ((Graphics2D) graphics)
          .setRenderingHint(RenderingHints.KEY_INTERPOLATION, RenderingHints.VALUE_INTERPOLATION_BILINEAR);
      graphics.drawImage(picture, (getWidth() - width) / 2, (getHeight() - height) / 2, width, height, null);
    }
  }
}
